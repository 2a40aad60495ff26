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

/// A bounding volume hierarchy (BVH) over triangles: finds the closest triangle to a point, and the
/// triangles near a box.
///
/// The triangles are sorted so that every four in a row share a box, every eight of those boxes in
/// a row share a larger one, and so on; sets are split across their longest side. So the hierarchy
/// consists of arrays and index arithmetic. Immutable; any number of threads may query it.
///
/// Bytes: 24 per point, 16 per triangle, 7 per triangle for the boxes.
class TriangleBvh {
 public:
  struct Hit : TrianglePoint {
    std::uint32_t triangle =
        kNone;  ///< index in the constructor's list; kNone: none is within `max_distance`
    bool found() const { return triangle != kNone; }
  };

  /// @param points     of the vertices, in a metric in which distances are lengths; |x| <= 1e18
  /// @param triangles  corners < points.size(); may be degenerate
  /// @cost  O(T log T)
  /// @post  the same hierarchy for any number of threads
  TriangleBvh(std::vector<Vec3> points, std::span<const Triangle> triangles,
              const RunControl& control = {});

  /// The closest point of all triangles, if it is no farther than `max_distance`. Of triangles at
  /// equal distance the smallest id. O(log T) for points near the triangles; a tight `max_distance`
  /// saves half of it.
  Hit closest(Vec3 p, double max_distance = std::numeric_limits<double>::infinity()) const;

  /// Appends to `out` the indices of the leaves, from `first` on, whose boxes overlap the closed
  /// box from `low` to `high`; may include some that nearly do. Together they contain every
  /// triangle whose own box overlaps it. The order is deterministic but unspecified. O(log T +
  /// leaves appended) for a box of the size of a leaf's.
  void leaves_near(Vec3 low, Vec3 high, std::uint32_t first, std::vector<std::uint32_t>& out) const;

  std::span<const Vec3> points() const { return points_; }

  // The triangles in the order of the hierarchy, in which neighbours are close together. `slot` <
  // triangle_count().
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(slots_.size()); }
  std::uint32_t triangle_in(std::uint32_t slot) const { return slots_[slot].triangle; }
  const Triangle& corners_in(std::uint32_t slot) const { return slots_[slot].corners; }

  // Leaf l has the slots from kLeafSize l to kLeafSize (l + 1), or to the end. `leaf` <
  // leaf_count().
  static constexpr std::uint32_t kLeafSize = 4;  // triangles per leaf
  std::uint32_t leaf_count() const { return (triangle_count() + kLeafSize - 1) / kLeafSize; }
  std::uint32_t leaf_end(std::uint32_t leaf) const {
    return std::min(triangle_count(), kLeafSize * (leaf + 1));
  }

 private:
  struct Slot {
    Triangle corners;
    std::uint32_t triangle;
  };
  static constexpr std::size_t kChildren = 8;  // boxes per node
  struct alignas(
      32) Node {  // the boxes of its children, axis by axis so that all are compared at once
    float centre[3][kChildren], half[3][kChildren];
  };
  struct Level {
    std::size_t first = 0, nodes = 0;
  };

  void sort_triangles(std::span<const Triangle> triangles, const RunControl& control);
  void make_boxes(const RunControl& control);

  std::vector<Vec3> points_;
  std::vector<Slot> slots_;
  std::vector<Node> nodes_;    // lowest level first; child k of node i is node 8 i + k of the level
                               // below, or that leaf
  std::vector<Level> levels_;  // lowest level first
};

}  // namespace isoatlas::detail
