// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "complex/components.h"
#include "isoatlas/options.h"

namespace isoatlas::detail {

/// The goals of the levels that ExtractOptions::levels requests, coarse to fine.
/// @param options  lengths in world units, checked
/// @param surface  in voxels; without dropped components
/// @param voxel    length of a voxel in world units
std::vector<LevelGoal> planned_levels(const ExtractOptions& options, const SurfaceComplex& surface,
                                      const Components& components, double voxel);

/// The largest bound of the distance, in the metric of the surface, at which a mesh of it keeps a
/// recognisable shape. It is a share of the size of the components, on average by area: a tiny
/// component does not refine a large one.
/// @cost O(F)
double recognisable_distance(const SurfaceComplex& surface, const Components& components);

}  // namespace isoatlas::detail
