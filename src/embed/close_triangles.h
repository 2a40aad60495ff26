// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/epoch_set.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"
#include "isoatlas/self_intersections.h"
#include "mesh/triangle_tree.h"

namespace isoatlas {

/// Finds pairs of triangles with overlapping boxes in a mesh that changes. There is a tree of the triangles as they were at some time, and
/// a list of those that changed since; when these are half of all, the tree is made anew.
class CloseTriangles {
 public:
  /// Whether a pair of triangles is wanted; called with their numbers, from several threads.
  using PairTest = std::function<bool(std::uint32_t, std::uint32_t)>;

  /// @param margin  triangles have the box of their corners, larger by this on all sides
  explicit CloseTriangles(double margin = 0) : margin_(margin) {}

  /// @param changed  the numbers of the triangles that are new since the last call or have a corner that moved, sorted
  /// @return the pairs with one of these that pass the test: sorted, the smaller number first
  /// @cost   O(T log T) where most changed; else O(changed log T), with a pass over the triangles now and then
  std::vector<TrianglePair> update(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                   std::span<const std::uint32_t> changed, const PairTest& is_wanted, const RunControl& control);

 private:
  // Positions about the origin and no longer than 2, for boxes in single precision. Neither step turns an order of coordinates around, so
  // boxes that overlap still do.
  struct Scaling {
    double first = 1, second = 1;  // in two steps: one power of two alone may not be a double
    Vec3 middle;
    Vec3 operator()(Vec3 p) const { return second * (first * p) - middle; }
  };
  static Scaling about_origin(std::span<const Vec3> positions);
  std::vector<TrianglePair> all_pairs(std::span<const Vec3> positions, const PairTest& is_wanted, const RunControl& control) const;
  void make_tree(std::span<const Vec3> positions, std::span<const Triangle> triangles);
  TriangleTree tree_of_changed(std::span<const Vec3> positions, std::span<const Triangle> triangles) const;
  double scaled_margin() const;

  double margin_;
  Scaling scaling_;
  std::optional<TriangleTree> tree_;
  std::vector<std::uint8_t> is_in_tree_;         // per triangle of the tree, 1 if it is still what it was
  std::vector<std::uint32_t> changed_since_;     // the tree was made
  EpochSet is_changed_, is_changed_now_;
};

}  // namespace isoatlas
