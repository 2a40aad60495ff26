// SPDX-License-Identifier: Apache-2.0
// Files that keep positions as float32 move vertices. What is said of a level is said of its files.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "isoatlas/hierarchy.h"
#include "isoatlas/report.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

struct FileRounding {
  std::string path;
  std::vector<std::size_t> levels;  ///< that the file holds
  double largest = 0;  ///< distance of a position from what is stored, in the mesh's units
};

/// Such a distance as a length in world units, an upper bound.
double rounding_in_world(double rounding, const Grid& grid, Space space);

/// Is it worth a word of its own, a hundredth of a voxel or more? It is in what is stated all the
/// same.
bool is_noticeable(double rounding_in_world, const Grid& grid);

/// Adds noticeable rounding to the distances of the vertices, which the page has colours for. Call
/// it after state_rounding().
void add_noticeable_rounding(Hierarchy& hierarchy, const ExtractReport& report, const Grid& grid);

/// Sets LevelReport::rounding to the largest one of the files that hold the level, and makes the
/// lengths of the report true of these files: a vertex that is moved by r changes a distance by at
/// most r and an edge by at most 2 r. A constraint that is violated only then is not met, and its
/// reason says so. Call it once, before files that carry the report of a level are written.
void state_rounding(ExtractReport& report, const std::vector<FileRounding>& files, const Grid& grid,
                    Space space);

}  // namespace isoatlas::detail
