// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/ids.h"
#include "geometry/closest_point.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// Finds the closest triangle to a point, and the triangles near a box: boxes within boxes.
///
/// The triangles are put in an order in which every four in a row share a box, every eight of those boxes in a row a larger
/// one, and so on; boxes are cut apart across their longest side. So the tree is arrays and arithmetic.
/// Immutable; any number of threads may ask at once.
///
/// Bytes: 24 per position, 16 per triangle, 7 per triangle for the boxes.
class TriangleTree {
 public:
  struct Hit : TrianglePoint {
    std::uint32_t triangle = kNone;  ///< as numbered in the constructor's list; kNone: none is within `at_most`
    bool found() const { return triangle != kNone; }
  };

  /// @param positions  where the vertices are, in a metric in which distances are lengths; |x| <= 1e18
  /// @param triangles  corners < positions.size(); may be degenerate
  /// @cost  O(T log T)
  /// @post  the same tree for any number of threads
  TriangleTree(std::vector<Vec3> positions, std::span<const Triangle> triangles, const RunControl& control = {});

  /// The closest point of all triangles, if it is no farther than `at_most`. Of triangles at equal distance the smallest id.
  /// O(log T) for points near the triangles; a tight `at_most` saves half of it.
  Hit closest(Vec3 p, double at_most = std::numeric_limits<double>::infinity()) const;

  /// Appends to `out` the numbers of the leaves, from `first` on, whose boxes meet the closed box from `low` to `high`; also some that
  /// only nearly do. Together they have every triangle whose own box meets it. The order is the same each time, but no particular one.
  /// O(log T + leaves appended) for a box the size of a leaf's.
  void leaves_near(Vec3 low, Vec3 high, std::uint32_t first, std::vector<std::uint32_t>& out) const;

  std::span<const Vec3> positions() const { return positions_; }

  // The triangles in the tree's order, in which neighbours are close together. `slot` < triangle_count().
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(slots_.size()); }
  std::uint32_t triangle_in(std::uint32_t slot) const { return slots_[slot].triangle; }
  const Triangle& corners_in(std::uint32_t slot) const { return slots_[slot].corners; }

  // Leaf l has the slots from kLeaf l to kLeaf (l + 1), or to the end. `leaf` < leaf_count().
  static constexpr std::uint32_t kLeaf = 4;  // triangles to a box of the lowest level
  std::uint32_t leaf_count() const { return (triangle_count() + kLeaf - 1) / kLeaf; }
  std::uint32_t leaf_end(std::uint32_t leaf) const { return std::min(triangle_count(), kLeaf * (leaf + 1)); }

 private:
  struct Slot {
    Triangle corners;
    std::uint32_t triangle;
  };
  static constexpr std::size_t kChildren = 8;  // boxes to a node
  struct alignas(32) Node {                    // the boxes of its children, axis by axis so that all are compared at once
    float centre[3][kChildren], half[3][kChildren];
  };
  struct Level {
    std::size_t first = 0, nodes = 0;
  };

  void order(std::span<const Triangle> triangles, const RunControl& control);
  void make_boxes(const RunControl& control);

  std::vector<Vec3> positions_;
  std::vector<Slot> slots_;
  std::vector<Node> nodes_;    // lowest level first; child k of node i is node 8 i + k of the level below, or that leaf
  std::vector<Level> levels_;  // lowest level first
};

}  // namespace isoatlas::detail
