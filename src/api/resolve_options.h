// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isoatlas/options.h"

namespace isoatlas::detail {

/// The length of which the default bound is a half: the smallest spacing, or a quarter of the
/// largest one if that is more. The surface between thick layers is interpolated. A mesh that
/// follows it more closely is not closer to the scanned object, and usually cannot be made, since
/// the surface complex has one c-vertex per grid cell.
double default_voxel(const Grid& grid);

/// A goal with all lengths in world units.
LevelGoal in_world(LevelGoal goal, const Grid& grid);

/// The options with all lengths in world units.
ExtractOptions in_world(ExtractOptions options, const Grid& grid);

}  // namespace isoatlas::detail
