// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace isoatlas::detail::io {

/// The files in the order of the number in their names: slice_2 before slice_10. Names differ in
/// that number only, or in several numbers that all rise together; the number rises by the same
/// step from file to file.
///
/// @throws Error(unsupported) names that are not alike, or that differ in several numbers
/// @throws Error(bad_file)    a number that is missing or there twice
std::vector<std::filesystem::path> in_slice_order(const std::filesystem::path& folder,
                                                  std::vector<std::filesystem::path> files);

}  // namespace isoatlas::detail::io
