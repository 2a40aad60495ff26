// SPDX-License-Identifier: Apache-2.0
// Code for the headers of NRRD and MetaImage: lines of text, numbers in them, and names of data
// files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "isoatlas/volume_file.h"

namespace isoatlas::detail::io {

/// `text` without blanks at its ends.
std::string_view trimmed(std::string_view text);

/// The words of `text`, which are separated by the characters of `separators`.
std::vector<std::string_view> words_of(std::string_view text, std::string_view separators = " \t");

/// `word` as a number, the same in any locale: "0.5", "-1e-3", "nan", "inf". Nothing if it is not a
/// number.
std::optional<double> number_of(std::string_view word);
std::optional<std::int64_t> integer_of(std::string_view word);

/// `pattern` with its one %d replaced by `number`: "slice%03d.raw" and 7 give "slice007.raw". %i
/// and %u are the same as %d; %% is a percent sign. Nothing unless there is exactly one.
std::optional<std::string> numbered_name(std::string_view pattern, std::int64_t number);

/// The path of the data file that a header calls `name`, relative to the header's folder.
/// Backslashes are taken as separators of folders if no file has a name with backslashes.
std::filesystem::path data_file_path(const std::filesystem::path& header_file,
                                     std::string_view name);

/// The largest number of data files that one header may name.
inline constexpr std::uint64_t kMostDataFiles = 1'000'000;

/// The beginning of the file, decompressed if the file is gzipped, at least up to the end of its
/// header.
///
/// @param is_whole  true if a text with this beginning contains the whole header
/// @throws Error(bad_file) if the header is longer than 64 MiB
std::string header_text(const std::filesystem::path& path, bool (*is_whole)(std::string_view text));

}  // namespace isoatlas::detail::io
