// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "optimize/mesh_editor.h"
#include "optimize/shape_goal.h"

namespace isoatlas::detail {

/// A change of one place of a mesh.
struct ShapeChange {
  double score = 0;  ///< worst of the triangles concerned, afterwards; 0: no change
  // A flip: triangles i and j become these.
  std::uint32_t i = kNone, j = kNone;
  DualTriangle first, second;
  // A move: cell's vertex goes to this c-vertex.
  CellId cell = kNone;
  CVertexId to = kNone;

  bool is_flip() const { return i != kNone; }
};

/// Finds changes for the better, among those that were not refused.
class ShapeChanges {
 public:
  /// @param with_given_up  vertices and edges may change, too, that were given up
  ShapeChanges(const MeshEditor& mesh, const ShapeGoal& goal, bool with_given_up)
      : mesh_(mesh), goal_(goal), with_given_up_(with_given_up) {}

  bool is_movable(CellId c) const { return with_given_up_ || mesh_.placement().is_movable(c); }
  double score(std::uint32_t triangle) const;

  /// Of the flips of a triangle's edges, or the moves of a cell's vertex to other c-vertices of the cell, the one with the best score, if
  /// that is better than `best`.
  /// @param gain  by which the worst triangle has to become better; none: it may be as it was, or good enough
  void consider_flips(std::uint32_t triangle, std::optional<double> gain, ShapeChange& best) const;
  void consider_moves(CellId cell, std::optional<double> gain, ShapeChange& best) const;

  /// It is not to be found again from the next call of sort_refused() on.
  void refuse(const ShapeChange& change) { refused_.push_back(key(change)); }
  void sort_refused();

 private:
  using Key = std::pair<std::uint64_t, std::uint64_t>;
  static Key key(const ShapeChange& change);
  bool is_refused(const ShapeChange& change) const;
  bool is_flippable(CellId c) const { return with_given_up_ || mesh_.placement().is_flippable(c); }
  std::pair<std::uint32_t, CellId> across(CellId a, CellId b) const;
  bool are_neighbours(CellId a, CellId b) const;
  Vec3 facing_of(std::uint32_t triangle) const;

  const MeshEditor& mesh_;
  const ShapeGoal& goal_;
  bool with_given_up_;
  std::vector<Key> refused_;
};

}  // namespace isoatlas::detail
