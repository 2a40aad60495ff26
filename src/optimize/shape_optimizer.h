// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "error/measured_covering.h"
#include "geometry/intersection_tracker.h"
#include "optimize/shape_goal.h"

namespace isoatlas::detail {

struct ShapeReport {
  std::size_t bad = 0;     ///< triangles below the goal at the end
  std::size_t flips = 0;   ///< edges flipped
  std::size_t moves = 0;   ///< vertices moved to another c-vertex
  std::size_t shifts = 0;  ///< vertices moved a little, within their grid cell
};

/// Works on badly shaped triangles one by one: flips one of their edges, or moves a vertex that is not frozen to another c-vertex
/// near by. A change is kept if the worst of the triangles it touches becomes better and no cell's metrics get over their bounds.
/// An edge is flipped only if the new one does not exist yet, so every flip leaves a simplicial manifold of the same topology.
///
/// @param triangles  the mesh's, changed by flips
ShapeReport improve_shape(MeasuredCovering& work, const ShapeGoal& goal, std::vector<DualTriangle>& triangles, const RunControl& control);

/// The same for those of `cells` that are over their bounds: a change is kept if the worst of the cells it concerns comes nearer to its
/// bounds, none other gets over them, and no triangle becomes bad. @pre what improve_shape() left
void improve_errors(MeasuredCovering& work, const ShapeGoal& goal, std::span<const CellId> cells, std::vector<DualTriangle>& triangles,
                    ShapeReport& report, const RunControl& control);

/// Takes changes back around triangles that meet others where they should not: vertices there go back to their sites and stay, triangles
/// become the dual's own again.
/// @param meeting  may know an earlier mesh of these cells
/// @return the corners of triangles that meet all the same, sorted
std::vector<CellId> take_back_meeting(MeasuredCovering& work, IntersectionTracker& meeting, std::vector<DualTriangle>& triangles,
                                      const RunControl& control);

/// Vertices go back to their c-vertices where surfels would meet if c-vertices were where their vertices are. @return whether any did
bool settle_vertices(MeasuredCovering& work, std::vector<DualTriangle>& triangles, const RunControl& control);

/// All changes.
void take_back_all(MeasuredCovering& work, std::vector<DualTriangle>& triangles, const RunControl& control);

/// More of improve_shape(), also where something was taken back, a change at a time that makes no triangles meet. @pre none do
/// @param meeting  may know an earlier mesh of these cells
void improve_shape_carefully(MeasuredCovering& work, const ShapeGoal& goal, IntersectionTracker& meeting,
                             std::vector<DualTriangle>& triangles, ShapeReport& report, const RunControl& control);

}  // namespace isoatlas::detail
