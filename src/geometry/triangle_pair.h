// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// Whether two triangles have a point in common beyond the convex hull of the corners they share, as self_intersections() has it.
/// Exact for all finite coordinates.
bool meet_beyond_shared(std::span<const Vec3> positions, const Triangle& a, const Triangle& b);

/// Whether two triangles certainly have no common point beyond what they share, wherever each coordinate of each corner is moved by up to
/// `slack`. Quick, and false where doubles cannot tell.
bool are_surely_apart(std::span<const Vec3> positions, const Triangle& a, const Triangle& b, double slack);

/// Whether the corners of a triangle are not on one line. Exact for all finite coordinates.
bool has_area(std::span<const Vec3> positions, const Triangle& t);

/// Counts the pairs of a few triangles for which meet_beyond_shared() is true, and stops at `enough`. Each position is compared with each
/// triangle's plane once for all pairs.
/// @param positions  the triangles' corners and no others
std::size_t meeting_pairs(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::size_t enough);

}  // namespace isoatlas::detail
