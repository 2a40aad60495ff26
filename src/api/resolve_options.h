// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isoatlas/options.h"

namespace isoatlas::detail {

/// The voxel that the default bound is half of: the smallest spacing, or a quarter of the largest one where that is more. Between layers
/// that are far apart the surface is interpolated: a mesh that followed it more closely would not be nearer to what was scanned, nor could
/// it, since the surface complex has one c-vertex per grid cell.
double default_voxel(const Grid& grid);

/// A goal with all lengths in world units.
LevelGoal in_world(LevelGoal goal, const Grid& grid);

/// The options with all lengths in world units.
ExtractOptions in_world(ExtractOptions options, const Grid& grid);

}  // namespace isoatlas::detail
