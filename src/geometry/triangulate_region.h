// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "isoatlas/mesh.h"

namespace isoatlas::detail {

struct PlanePoint {
  double u = 0, v = 0;
};

/// A directed side of a region of the plane, from one point to another. The region is on its left.
using RegionSide = std::array<std::uint32_t, 2>;

/// Triangulates a region of the plane that is bounded by closed polygons: a constrained Delaunay
/// triangulation, up to rounding. It has no points but those of the polygons. Triangles are
/// counter-clockwise.
/// @param points   all points; those without a side are ignored
/// @param sides    in any order
/// @param spacing  lengths along u and v are multiplied by it before angles are compared
/// @return nothing if the sides do not bound a region: a point does not have one side to it and
///         one from it, sides cross, or something is on the left of two sides
/// @post  every side is an edge of one triangle, every other edge of two
/// @cost  O(n log n)
/// @source de Berg, Cheong, van Kreveld, Overmars, Computational Geometry, 3rd edition, chapter 3
///         (monotone polygons); Lawson's flips
std::optional<std::vector<Triangle>> triangulate_region(std::span<const PlanePoint> points,
                                                        std::span<const RegionSide> sides,
                                                        PlanePoint spacing = {1, 1});

}  // namespace isoatlas::detail
