// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/epoch_set.h"
#include "geometry/triangle_tree.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"
#include "isoatlas/self_intersections.h"

namespace isoatlas::detail {

/// Finds pairs of triangles with overlapping boxes in a mesh that changes. Triangles that change together are in a tree of their own; a
/// tree that is not twice as large as the next one is joined with it. So there are few trees, and each triangle is sorted into a few only.
class CloseTriangles {
 public:
  /// Whether a pair of triangles is wanted; called with their numbers, from several threads.
  using PairTest = std::function<bool(std::uint32_t, std::uint32_t)>;

  /// @param margin  triangles have the box of their corners, larger by this on all sides
  explicit CloseTriangles(double margin = 0) : margin_(margin) {}

  /// @param changed  the numbers of the triangles that are new since the last call or have a corner that moved, sorted
  /// @return the pairs with one of these that pass the test: sorted, the smaller number first
  /// @cost   O(T log T) where most changed; else O(changed (log T)^2), amortized, and little more than O(changed log T)
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
  // Triangles that changed at the same time or were joined since. Of those in the tree, only those whose tree_of_ it is are current.
  struct Tree {
    std::uint32_t id;
    std::size_t current;                 // how many are
    std::vector<std::uint32_t> numbers;  // per triangle of the tree
    TriangleTree tree;
  };
  static Scaling about_origin(std::span<const Vec3> positions);
  double scaled_margin() const;
  void add_tree(std::vector<std::uint32_t> numbers, std::span<const Vec3> positions, std::span<const Triangle> triangles,
                const RunControl& control);
  void leave_tree(std::uint32_t t);
  std::vector<std::uint32_t> current(const Tree& tree) const;
  std::vector<TrianglePair> all_pairs(std::span<const Vec3> positions, std::span<const Triangle> triangles, const PairTest& is_wanted,
                                      const RunControl& control);

  double margin_;
  Scaling scaling_;
  std::vector<Tree> trees_;             // from large to small, from old to new
  std::vector<std::uint32_t> tree_of_;  // per triangle, the id of its tree
  std::uint32_t next_id_ = 0;
  EpochSet is_changed_;
};

}  // namespace isoatlas::detail
