// SPDX-License-Identifier: Apache-2.0
// What a legacy VTK file says of its grid and its arrays, and where their values are. "VTK File
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
  std::uint64_t ignored_bytes = 0;  ///< at the end, where no section begins
};

/// Goes through the whole file; values are skipped.
/// @throws Error(bad_file)     cut off, damaged, or sizes that contradict each other
/// @throws Error(unsupported)  another data set than points with equal steps
LegacyVtkHeader read_legacy_vtk_header(const std::filesystem::path& path);

}  // namespace isoatlas::detail::io
