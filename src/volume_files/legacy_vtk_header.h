// SPDX-License-Identifier: Apache-2.0
// The grid and the arrays that a legacy VTK file states, and the places of their values. "VTK File
// Formats" (the VTK User's Guide) describes the format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "volume_files/legacy_vtk_scanner.h"
#include "volume_files/vtk_array.h"

namespace isoatlas::detail::io {

struct LegacyVtkHeader {
  bool is_text = false;
  VtkGrid grid = {};
  bool has_spacing = false;
  std::vector<LegacyVtkArray> arrays = {};
  std::uint64_t ignored_bytes = 0;  ///< after the last section
};

/// Reads through the whole file, but skips the values.
/// @throws Error(bad_file)     if it is cut off or damaged, or states contradictory sizes
/// @throws Error(unsupported)  if the data set is not a grid of points with equal steps
LegacyVtkHeader read_legacy_vtk_header(const std::filesystem::path& path);

}  // namespace isoatlas::detail::io
