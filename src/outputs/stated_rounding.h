// SPDX-License-Identifier: Apache-2.0
// Files that keep positions as float32 move vertices. What is said of a level is said of its files.
#pragma once

#include <vector>

#include "isoatlas/extract.h"
#include "isoatlas/volume.h"
#include "report/report.h"

namespace isoatlas {

/// The rounding of a file as a length in world units, an upper bound.
double rounding_in_world(const ReportFile& file, const Grid& grid, Space space);

/// Sets LevelReport::rounding to the largest one of the files that hold the level, and makes the lengths of the report true of
/// these files: a vertex that is moved by r changes a distance by at most r and an edge by at most 2 r. A constraint that is violated
/// only then is not met, and its reason says so. Call it once, after the files are written.
void state_rounding(ExtractReport& report, const std::vector<ReportFile>& files, const Grid& grid, Space space);

}  // namespace isoatlas
