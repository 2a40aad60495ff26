// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/slack_rows.h"
#include "error/level_mesh.h"
#include "field/interpolated_field.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// The box that a vertex may move in, metric; if low == high it is fixed.
struct MoveBounds {
  Vec3 low, high;
};

/// The grid cell that contains a c-vertex, shrunk a little; along an axis along which the c-vertex
/// is on a wall, that wall. A vertex that stays in this box keeps the complex valid: one c-vertex
/// in every surfel.
/// @param position  in sample-index coordinates
MoveBounds move_bounds_of(Vec3 position, Vec3 spacing);

struct RelaxGoal {
  double aspect = 0;      ///< smallest ratio of shortest to longest edge of a triangle
  double separation = 0;  ///< shortest edge wanted, metric
  bool push = true;  ///< push vertices before searching for better points; without it other points
                     ///< are found
};

/// Moves vertices a little, within their boxes, until triangles have a better shape: the ends of an
/// edge that is too short are pushed apart, those of the longest edge are pulled together, and
/// moved vertices are pulled back towards the surface, which they may leave by at most 0.4 voxel.
/// No triangle is inverted. Only badly shaped places are changed.
///
/// @param points  metric; lengths in voxels (smallest spacings)
/// @param triangles_of  per vertex, the triangles with a corner there
/// @param field   the surface is its zero set; none: vertices are not pulled back
/// @param bounds_of  returns the box of a vertex
/// @param candidates  the triangles that may be badly shaped, sorted
/// @return the vertices that were moved, sorted
/// @cost   O(triangles) if any is badly shaped, plus a few dozen evaluations around these
std::vector<std::uint32_t> relax(std::span<Vec3> points, std::span<const Triangle> triangles,
                                 const SlackRows<std::uint32_t>& triangles_of,
                                 const std::function<MoveBounds(std::uint32_t)>& bounds_of,
                                 const InterpolatedField* field, Vec3 spacing,
                                 const RelaxGoal& goal, const RunControl& control,
                                 std::span<const std::uint32_t> candidates);

}  // namespace isoatlas::detail
