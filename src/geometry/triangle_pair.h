// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// Whether two triangles intersect beyond the convex hull of the corners that they share, as
/// defined for self_intersections(). Exact for all finite coordinates.
bool intersect_beyond_shared_simplex(std::span<const Vec3> positions, const Triangle& a,
                                     const Triangle& b);

/// Whether two triangles certainly do not intersect beyond what they share, even if each coordinate
/// of each corner moves by up to `slack`. Fast; false if doubles do not suffice to decide.
bool are_certainly_disjoint(std::span<const Vec3> positions, const Triangle& a, const Triangle& b,
                            double slack);

/// Whether the corners of a triangle are not collinear. Exact for all finite coordinates.
bool has_area(std::span<const Vec3> positions, const Triangle& t);

/// Counts the intersecting pairs among a few triangles, as intersect_beyond_shared_simplex()
/// defines them, and stops at `max_count`. Each position is compared with each triangle's plane
/// only once.
/// @param positions  only the triangles' corners
std::size_t count_intersecting_pairs(std::span<const Vec3> positions,
                                     std::span<const Triangle> triangles, std::size_t max_count);

}  // namespace isoatlas::detail
