// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "optimize/mesh_editor.h"
#include "optimize/shape_goal.h"

namespace isoatlas::detail {

/// A change at one place of a mesh.
struct ShapeChange {
  double score = 0;  ///< worst score of the affected triangles afterwards; 0: no change
  // A flip replaces triangles i and j by these.
  std::uint32_t i = kNone, j = kNone;
  DualTriangle first, second;
  // A move places the cell's vertex at this c-vertex.
  CellId cell = kNone;
  CVertexId to = kNone;

  bool is_flip() const { return i != kNone; }
};

/// Finds changes that improve the shape, among those that were not rejected.
class ShapeChanges {
 public:
  /// @param include_fixed  also changes vertices and edges that are fixed
  ShapeChanges(const MeshEditor& mesh, const ShapeGoal& goal, bool include_fixed)
      : mesh_(mesh), goal_(goal), include_fixed_(include_fixed) {}

  bool is_movable(CellId c) const { return include_fixed_ || mesh_.placement().is_movable(c); }
  double score(std::uint32_t triangle) const;
  bool is_at_shared_face(std::uint32_t triangle) const;

  /// Finds the best flip of a triangle's edges, or the best move of a cell's vertex to another
  /// c-vertex of the cell, if its score is better than `best`.
  /// @param min_gain  by how much the worst triangle must improve; none: it may stay equal, or be
  ///                  good enough
  void find_best_flip(std::uint32_t triangle, std::optional<double> min_gain,
                      ShapeChange& best) const;
  void find_best_move(CellId cell, std::optional<double> min_gain, ShapeChange& best) const;

  /// The change will not be found again after the next sort_rejected().
  void reject(const ShapeChange& change) { rejected_.push_back(key(change)); }
  void sort_rejected();

 private:
  using Key = std::pair<std::uint64_t, std::uint64_t>;
  static Key key(const ShapeChange& change);
  bool is_rejected(const ShapeChange& change) const;
  bool could_be_on_closed_face(CellId a, CellId b) const;
  bool is_flippable(CellId c) const { return include_fixed_ || mesh_.placement().is_flippable(c); }
  std::pair<std::uint32_t, CellId> opposite(CellId a, CellId b) const;
  bool are_neighbours(CellId a, CellId b) const;
  Vec3 face_direction_of(std::uint32_t triangle) const;

  const MeshEditor& mesh_;
  const ShapeGoal& goal_;
  bool include_fixed_;
  std::vector<Key> rejected_;
};

}  // namespace isoatlas::detail
