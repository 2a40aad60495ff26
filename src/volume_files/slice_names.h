// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace isoatlas::detail::io {

/// The files in the order of the number in their names: slice_2 precedes slice_10. The names differ
/// only in that number, or in several numbers that all increase together; the number increases by
/// the same step from file to file.
///
/// @throws Error(unsupported) if the names are not alike, or differ in several numbers
/// @throws Error(bad_file)    if a number is missing or occurs twice
std::vector<std::filesystem::path> in_slice_order(const std::filesystem::path& folder,
                                                  std::vector<std::filesystem::path> files);

}  // namespace isoatlas::detail::io
