// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "error/measured_covering.h"
#include "voronoi/covering.h"

namespace isoatlas::detail {

/// Guesses, at some c-vertices, the radius of disks that keeps a mesh within `bound` of the surface: from how far the surface around a
/// c-vertex is from being flat, as if it went on with that curvature. A little too large on average, since what is too large is seen when
/// the mesh is measured, and what is too small is not. Nothing for a c-vertex with hardly any other ones around it.
/// @cost  O(at.size()), about 50 c-vertices each. Parallel
std::vector<Covering::Radius> predict_radii(const SurfaceData& surface_data, std::span<const CVertexId> at, double bound);

}  // namespace isoatlas::detail
