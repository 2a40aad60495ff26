// SPDX-License-Identifier: Apache-2.0
// Checks that a file holds the samples that its header states. Many libraries fill missing samples
// with zeros or leave memory uninitialised, and a surface of such samples looks like anatomy. So
// every reader calls these functions first.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace isoatlas::detail::io {

/// For uncompressed samples. Throws Error(bad_file) if `stored` is less than `stated`.
void require_stored_bytes(const std::filesystem::path& path, std::uint64_t stated,
                          std::uint64_t stored);

/// For compressed or textual samples, before memory is allocated for them. Throws Error(bad_file)
/// if no compressor can put `stated` bytes into `stored`. Deflate shrinks data to 1/1032 at most.
void require_possible_bytes(const std::filesystem::path& path, std::uint64_t stated,
                            std::uint64_t stored, std::uint64_t most_per_stored_byte = 1100);

/// Throws Error(bad_file) unless the file ends with `ending`, apart from blanks. A file that was
/// cut off does not.
void require_ending(const std::filesystem::path& path, std::string_view ending);

/// Checks a data file that a header names. Its errors also name the header, which is the file that
/// the user gave.
void check_data_file(const std::filesystem::path& header_file,
                     const std::filesystem::path& data_file, const std::function<void()>& check);

/// The first bytes of a file, at most `limit`; decompressed if the file is gzipped.
std::string first_bytes(const std::filesystem::path& path, std::size_t limit);

}  // namespace isoatlas::detail::io
