// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "error/measured_covering.h"
#include "voronoi/covering.h"

namespace isoatlas::detail {

/// Predicts, for some c-vertices, the radius of disks that keeps a mesh within `bound` of the
/// surface: measures how far the neighbourhood of a c-vertex is from a plane, and extrapolates with
/// this curvature. The prediction is a little too large on average, since cells that are too large
/// are found when the mesh is measured, and cells that are too small are not. C-vertices with too
/// few neighbours are left out.
/// @cost  O(at.size()), about 50 c-vertices each. Parallel
std::vector<Covering::Radius> predict_radii(const SurfaceData& surface_data,
                                            std::span<const CVertexId> at, double bound);

}  // namespace isoatlas::detail
