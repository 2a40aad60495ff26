// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "isoatlas/mesh.h"

namespace isoatlas {

/// Whether two triangles have a point in common beyond the convex hull of the corners they share, as self_intersections() has it.
/// Exact for all finite coordinates.
bool meet_beyond_shared(std::span<const Vec3> positions, const Triangle& a, const Triangle& b);

/// How many pairs of a few triangles meet where they should not; where there are as many as `enough`, that. The same answers, but on which
/// side of which triangle the positions are is found out once for all pairs.
/// @param positions  no others than the triangles' corners
std::size_t meeting_pairs(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::size_t enough);

}  // namespace isoatlas
