// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "error/measured_covering.h"
#include "geometry/intersection_tracker.h"
#include "optimize/shape_goal.h"

namespace isoatlas::detail {

struct ShapeReport {
  std::size_t bad = 0;            ///< badly shaped triangles at the end
  std::size_t flips = 0;          ///< number of flipped edges
  std::size_t moves = 0;          ///< number of vertices moved to another c-vertex
  std::size_t displacements = 0;  ///< number of vertices displaced within their grid cells
};

/// Improves badly shaped triangles one by one: flips one of their edges, or moves a vertex without
/// a fixed anchor to another c-vertex near it. A change is kept if the worst of the triangles it
/// affects improves and no cell violates its bounds because of it. An edge is flipped only if the
/// new edge does not exist yet, so every flip preserves a simplicial manifold of the same topology.
///
/// @param triangles  those of the mesh; changed by flips
ShapeReport improve_shape(MeasuredCovering& measured, const ShapeGoal& goal,
                          std::vector<DualTriangle>& triangles, const RunControl& control);

/// The same for those of `cells` that violate their bounds: a change is kept if the error of the
/// worst affected cell decreases, no other cell violates its bounds because of it, and no triangle
/// becomes badly shaped. @pre `triangles` comes from improve_shape()
void improve_errors(MeasuredCovering& measured, const ShapeGoal& goal,
                    std::span<const CellId> cells, std::vector<DualTriangle>& triangles,
                    ShapeReport& report, const RunControl& control);

/// Reverts changes around triangles that intersect others: vertices there return to their sites and
/// are fixed, and flipped triangles become the dual's again.
/// @param tracker  may hold an earlier mesh of these cells
/// @return the corners of triangles that still intersect, sorted
std::vector<CellId> revert_intersecting(MeasuredCovering& measured, IntersectionTracker& tracker,
                                        std::vector<DualTriangle>& triangles,
                                        const RunControl& control);

/// Returns vertices to their c-vertices where surfels would intersect if the c-vertices had the
/// positions of their vertices. @return whether any was returned
bool revert_conflicting_moves(MeasuredCovering& measured, std::vector<DualTriangle>& triangles,
                              const RunControl& control);

/// Reverts changes around these cells, and where cells violate their bounds because of that, around
/// those as well. @return whether there were any
bool revert_at(MeasuredCovering& measured, std::span<const CellId> cells,
               std::vector<DualTriangle>& triangles, const RunControl& control);

/// Reverts all changes.
void revert_all(MeasuredCovering& measured, std::vector<DualTriangle>& triangles,
                const RunControl& control);

/// Continues improve_shape(), also where changes were reverted, with changes that create no
/// intersections. @pre the mesh has none
/// @param tracker  may hold an earlier mesh of these cells
void improve_shape_without_intersections(MeasuredCovering& measured, const ShapeGoal& goal,
                                         IntersectionTracker& tracker,
                                         std::vector<DualTriangle>& triangles, ShapeReport& report,
                                         const RunControl& control);

}  // namespace isoatlas::detail
