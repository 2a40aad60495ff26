// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "error/measured_covering.h"
#include "geometry/intersection_tracker.h"

namespace isoatlas::detail {

/// Edits a level's mesh between two updates of its covering: flips edges and moves vertices,
/// measures what this affects, and finds the intersections. Costs are proportional to the changes,
/// except for the first intersection test.
class MeshEditor {
 public:
  /// @param triangles  those of the mesh
  /// @param tracker    follows the changes; may hold an earlier mesh of these cells; none:
  ///                   intersections are not tested
  MeshEditor(MeasuredCovering& measured, std::vector<DualTriangle>& triangles,
             IntersectionTracker* tracker, const RunControl& control);

  const MeasuredCovering& measured() const { return measured_; }
  const LevelMesh& mesh() const { return measured_.mesh(); }
  const VertexPlacement& placement() const { return measured_.placement(); }
  const SurfaceData& surface_data() const { return measured_.surface_data(); }
  double excess(CellId c) const { return measured_.errors()[c].excess; }
  const DualTriangle& triangle(std::uint32_t t) const { return triangles_[t]; }
  bool is_occupied(CVertexId v) const {
    return occupied_[v] != 0;
  }  ///< whether a vertex is placed there

  // These changes are collected; the mesh itself changes in measure().
  void set_triangle(std::uint32_t t, const DualTriangle& to);
  void move(CellId c, CVertexId anchor, Vec3 displacement);
  void displace(CellId c, Vec3 displacement) { move(c, placement().anchor[c], displacement); }
  void fix(CellId c, std::uint8_t degree);  ///< raises VertexPlacement::fixed to at least this

  /// Applies the changes to the mesh and measures the affected cells again.
  void measure(std::span<const CellId> affected);

  /// The k-ring of the cells: the cells and all that at most k edges connect with them; sorted.
  std::vector<CellId> k_ring(std::span<const CellId> cells, int k) const;
  /// The cells whose errors depend on triangles or vertices of these cells, sorted.
  std::vector<CellId> affected_by(std::span<const CellId> cells) const {
    return k_ring(cells, affected_ring_);
  }

  /// The corners of triangles that intersect now, sorted; empty without a tracker.
  std::vector<CellId> intersecting_corners();
  /// The triangles that have changed, or have a corner that moved, since the last call; sorted; may
  /// include unchanged ones.
  std::vector<std::uint32_t> take_changed_triangles();

  /// Reverts displacements where surfels of one grid cell would intersect.
  /// @param before  for each of the cells, the displacement to return to
  /// @return the cells whose vertices were reverted
  std::vector<CellId> revert_conflicting_moves(std::span<const CellId> cells,
                                               std::span<const Vec3> before);

 private:
  void set_position(CVertexId v, Vec3 position);

  MeasuredCovering& measured_;
  std::vector<DualTriangle>& triangles_;
  IntersectionTracker* tracker_;
  const RunControl& control_;
  int affected_ring_;  // errors within this k-ring are affected by a change; balancing also moves
                       // vertices next to the change
  std::vector<std::uint8_t> occupied_;  // per c-vertex
  MeshEdit edit_;                       // not yet applied to the mesh
  std::vector<std::uint32_t> changed_;  // triangles changed since take_changed_triangles()
  bool is_tracker_current_ = false;     // except for moved_ and changed_since_test_
  std::vector<CellId> moved_;  // cells whose vertices moved since the last intersection test
  std::vector<std::uint32_t>
      changed_since_test_;       // triangles changed since the last intersection test
  std::vector<Vec3> positions_;  // per c-vertex of the surface, the position of the vertex placed
                                 // there; empty until needed
};

}  // namespace isoatlas::detail
