// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/epoch_set.h"
#include "geometry/triangle_bvh.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"
#include "isoatlas/self_intersections.h"

namespace isoatlas::detail {

/// Finds pairs of triangles with overlapping boxes in a mesh that changes. Triangles that change
/// together get a bounding volume hierarchy (BVH) of their own; a BVH that is less than twice as
/// large as the next one is merged with it. So there are few, and each triangle is rebuilt into
/// only a few.
class CloseTriangles {
 public:
  /// Whether a pair of triangles is wanted; called with their ids, from several threads.
  using PairTest = std::function<bool(std::uint32_t, std::uint32_t)>;

  /// @param margin  the boxes of triangles are enlarged by this on all sides
  explicit CloseTriangles(double margin = 0) : margin_(margin) {}

  /// The first mesh, if its pairs are not wanted: only later changes are tested.
  /// @cost  O(T log T)
  void start(std::span<const Vec3> positions, std::span<const Triangle> triangles,
             const RunControl& control);

  /// @param changed  the ids of the triangles that are new since the last call or have a corner
  ///                 that moved, sorted
  /// @return the pairs with at least one of these that pass the test: sorted, the smaller id first
  /// @cost   O(T log T) where most changed; otherwise amortized O(changed (log T)^2), and little
  ///         more than O(changed log T)
  std::vector<TrianglePair> update(std::span<const Vec3> positions,
                                   std::span<const Triangle> triangles,
                                   std::span<const std::uint32_t> changed,
                                   const PairTest& is_wanted, const RunControl& control);

 private:
  // Translates and scales positions so that they are centred at the origin and no longer than 2,
  // for boxes in single precision. Neither step reverses an order of coordinates, so boxes that
  // overlap still do.
  struct Scaling {
    double first = 1,
           second = 1;  // in two steps, because one power of two alone may not be a double
    Vec3 middle;
    Vec3 operator()(Vec3 p) const { return second * (first * p) - middle; }
  };
  // Triangles that changed at the same time or were merged since. A triangle in the BVH is current
  // only if bvh_of_ refers to it.
  struct IndexedBvh {
    std::uint32_t id;
    std::size_t current;             // number of current triangles
    std::vector<std::uint32_t> ids;  // per triangle of the BVH, its id in the mesh
    TriangleBvh bvh;
  };
  static Scaling centred_scaling(std::span<const Vec3> positions);
  double scaled_margin() const;
  void add_bvh(std::vector<std::uint32_t> ids, std::span<const Vec3> positions,
               std::span<const Triangle> triangles, const RunControl& control);
  void index_all(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                 const RunControl& control);
  void remove_from_bvh(std::uint32_t t);
  std::vector<std::uint32_t> current(const IndexedBvh& bvh) const;
  std::vector<TrianglePair> all_pairs(std::span<const Vec3> positions,
                                      std::span<const Triangle> triangles,
                                      const PairTest& is_wanted, const RunControl& control);

  double margin_;
  Scaling scaling_;
  std::vector<IndexedBvh> bvhs_;       // from large to small, from old to new
  std::vector<std::uint32_t> bvh_of_;  // per triangle, the id of its BVH
  std::uint32_t next_id_ = 0;
  EpochSet is_changed_;
};

}  // namespace isoatlas::detail
