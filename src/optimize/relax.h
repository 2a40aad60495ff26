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

/// Where a vertex may go: a box, spacing applied. Where low == high it stays.
struct Roam {
  Vec3 low, high;
};

/// The grid cell that holds a c-vertex, a little smaller; along an axis along which it is on the cell's wall, that wall. A vertex that
/// stays there keeps the complex as it is: one c-vertex in every surfel.
/// @param position  in sample-index coordinates
Roam roam_of(Vec3 position, Vec3 spacing);

struct RelaxGoal {
  double aspect = 0;      ///< shortest over longest edge of a triangle, at least
  double separation = 0;  ///< no shorter edge, if possible; spacing applied
  bool push = true;       ///< push vertices before better places are searched for; without it other places are found
};

/// Moves vertices a little, within their boxes, until triangles have a better shape: the ends of an edge that is too short are pushed
/// apart, those of the longest one pulled together, and vertices that are moved are drawn back towards the surface, which they may
/// leave by 0.4 voxel at most. No triangle is turned over. Only places that need it are touched.
///
/// @param points  spacing applied; lengths in voxels (smallest spacings)
/// @param triangles_of  per vertex, the triangles with a corner there
/// @param field   whose zero set is the surface; none: nothing draws vertices back
/// @param roam    of a vertex
/// @param look    the triangles that may need it, sorted
/// @return the vertices that were moved, sorted
/// @cost   O(triangles) if any needs it, then a few dozen looks at those concerned
std::vector<std::uint32_t> relax(std::span<Vec3> points, std::span<const Triangle> triangles, const SlackRows<std::uint32_t>& triangles_of,
                                 const std::function<Roam(std::uint32_t)>& roam, const InterpolatedField* field, Vec3 spacing,
                                 const RelaxGoal& goal, const RunControl& control, std::span<const std::uint32_t> look);

}  // namespace isoatlas::detail
