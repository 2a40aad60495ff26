// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "error/measured_covering.h"
#include "geometry/intersection_tracker.h"

namespace isoatlas::detail {

/// Changes a level's mesh between two updates of its covering: flips edges and moves vertices, measures what that concerns, and says what
/// intersects then. Costs what is changed, but for the first look.
class MeshEditor {
 public:
  /// @param triangles  the mesh's
  /// @param meeting    is told what changes; may know an earlier mesh of these cells; none: intersections are not looked at
  MeshEditor(MeasuredCovering& work, std::vector<DualTriangle>& triangles, IntersectionTracker* meeting, const RunControl& control);

  const MeasuredCovering& work() const { return work_; }
  const LevelMesh& mesh() const { return work_.mesh(); }
  const VertexPlacement& placement() const { return work_.placement(); }
  const SurfaceData& surface_data() const { return work_.surface_data(); }
  double excess(CellId c) const { return work_.errors()[c].excess; }
  const DualTriangle& triangle(std::uint32_t t) const { return triangles_[t]; }
  bool is_occupied(CVertexId v) const { return occupied_[v] != 0; }  ///< a vertex sits there

  // The mesh itself changes in measure().
  void set_triangle(std::uint32_t t, const DualTriangle& to);
  void move(CellId c, CVertexId anchor, Vec3 shift);
  void shift(CellId c, Vec3 shift) { move(c, placement().anchor[c], shift); }
  void give_up(CellId c, std::uint8_t what);  ///< VertexPlacement::fixed is at least this from now on

  /// Changes the mesh and measures the cells again that this may concern.
  void measure(std::span<const CellId> concerned);

  /// The cells and those around them, so many rings, sorted.
  std::vector<CellId> around(std::span<const CellId> cells, int rings) const;
  /// The cells whose metrics a change of triangles or vertices of these cells concerns, sorted.
  std::vector<CellId> concerned_by(std::span<const CellId> cells) const { return around(cells, rings_); }

  /// The corners of triangles that intersect now, sorted; none if nobody asked to look.
  std::vector<CellId> meeting_corners();
  /// The triangles that have changed since the last call, or have a corner that moved, sorted; among them some that did not.
  std::vector<std::uint32_t> take_changed();

  /// Vertices that are not shifted as before get that shift again where surfels of one grid cell would intersect.
  /// @param before  the shift of each of the cells, one by one
  /// @return those that got it
  std::vector<CellId> keep_from_straying(std::span<const CellId> cells, std::span<const Vec3> before);

 private:
  void set_position(CVertexId v, Vec3 position);

  MeasuredCovering& work_;
  std::vector<DualTriangle>& triangles_;
  IntersectionTracker* meeting_;
  const RunControl& control_;
  int rings_;                           // of cells around a change that it concerns; balancing moves vertices beside it
  std::vector<std::uint8_t> occupied_;  // per c-vertex
  MeshEdit edit_;                       // not yet in the mesh
  std::vector<std::uint32_t> changed_;  // triangles, since take_changed()
  bool does_meeting_know_ = false;      // all but the following
  std::vector<CellId> moved_;           // since the last look at intersections
  std::vector<std::uint32_t> remade_;   // triangles, since then
  std::vector<Vec3> positions_;         // per c-vertex of the surface, that of the vertex that sits there; empty: not needed yet
};

}  // namespace isoatlas::detail
