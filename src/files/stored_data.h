// SPDX-License-Identifier: Apache-2.0
// Checks that a file holds the samples that its header promises. Many libraries fill what is
// missing with zeros, or leave what was in memory. A surface of that would look like anatomy, so
// every reader checks here first.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace isoatlas::detail::io {

/// Uncompressed samples. Throws Error(bad_file) if `stored` is less than `promised`.
void require_stored_bytes(const std::filesystem::path& path, std::uint64_t promised,
                          std::uint64_t stored);

/// Compressed or textual samples, before memory is allocated for them: throws Error(bad_file) if no
/// compressor could have put `promised` bytes into `stored`. Deflate shrinks nothing below 1/1032.
void require_possible_bytes(const std::filesystem::path& path, std::uint64_t promised,
                            std::uint64_t stored, std::uint64_t most_per_stored_byte = 1100);

/// Throws Error(bad_file) unless the file ends with `ending`, blanks aside: a file that lost its
/// end does not.
void require_ending(const std::filesystem::path& path, std::string_view ending);

/// Checks a data file that a header names: an Error about it also names the header, which is what
/// the user gave.
void check_data_file(const std::filesystem::path& header_file,
                     const std::filesystem::path& data_file, const std::function<void()>& check);

/// The first bytes of a file, at most `limit`; decompressed if the file is gzipped.
std::string first_bytes(const std::filesystem::path& path, std::size_t limit);

}  // namespace isoatlas::detail::io
