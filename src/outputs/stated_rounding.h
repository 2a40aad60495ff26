// SPDX-License-Identifier: Apache-2.0
// Adds the rounding of positions in float32 files to the distances and lengths of a report.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "isoatlas/hierarchy.h"
#include "isoatlas/report.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// How far a file rounds positions.
struct FileRounding {
  std::string path;
  std::vector<std::size_t> levels;  ///< the levels in the file
  double largest =
      0;  ///< largest distance between a position and the stored one, in the mesh's units
};

/// An upper bound in world units of a rounding that is given in the units of a mesh.
double rounding_in_world(double rounding, const Grid& grid, Space space);

/// True if a rounding is at least a hundredth of a voxel. Then the summary mentions it; reported
/// lengths include it in any case.
bool is_noticeable(double rounding_in_world, const Grid& grid);

/// Adds the rounding of a level, if is_noticeable(), to Hierarchy::Level::distance, which the page
/// shows as colours. Call it after state_rounding().
void add_noticeable_rounding(Hierarchy& hierarchy, const ExtractReport& report, const Grid& grid);

/// Sets LevelReport::rounding to the largest rounding of the files that contain the level, and
/// makes the lengths in the report bounds for these files: if vertices move by up to r, a distance
/// changes by at most r and an edge by at most 2 r. A constraint that is violated only because of
/// this becomes violated, with the rounding as the reason. Call it once, before files that contain
/// the report of a level are written.
void state_rounding(ExtractReport& report, const std::vector<FileRounding>& files, const Grid& grid,
                    Space space);

}  // namespace isoatlas::detail
