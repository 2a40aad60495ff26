// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "geometry/close_triangles.h"
#include "geometry/output_positions.h"

namespace isoatlas::detail {

/// The self-intersections of a mesh that changes, and its triangles without area, in the
/// coordinates that are written to files. Call update() for each new version of the mesh: only
/// triangles that changed are tested again. A triangle whose corners are one vertex was removed.
class IntersectionTracker {
 public:
  explicit IntersectionTracker(OutputPositions forms = {})
      : forms_(std::move(forms)), close_(forms_.max_rounding()) {}

  /// The first mesh, without a test: only triangles that change later are tested.
  void start(std::span<const Vec3> positions, std::span<const Triangle> triangles,
             const RunControl& control);

  /// Tests all forms of the positions.
  /// @param positions  in sample-index coordinates
  /// @param triangles  an unchanged triangle must keep its id, otherwise it counts as changed
  /// @return the corners of all triangles that intersect or have no area in any of the forms,
  ///         sorted
  /// @cost   as self_intersections() for the first call; then the neighbourhood of changed
  ///         triangles, and a comparison with the last mesh
  std::vector<std::uint32_t> update(std::span<const Vec3> positions,
                                    std::span<const Triangle> triangles, const RunControl& control);

  /// The same if only these vertices have moved since the last mesh.
  /// @param at       their new positions
  /// @param changed  the ids of triangles with other corners or a corner that moved, sorted
  /// @param corners  of these triangles
  /// @cost   the neighbourhood of changed triangles
  std::vector<std::uint32_t> update(std::span<const std::uint32_t> vertices,
                                    std::span<const Vec3> at,
                                    std::span<const std::uint32_t> changed,
                                    std::span<const Triangle> corners, const RunControl& control);

  /// For each intersecting pair the largest corner, or all six if the largest has size 0; sorted.
  std::vector<std::uint32_t> largest_corners(std::span<const float> size_of_vertex) const;

  /// The intersecting pairs that were found and still intersect; a triangle without area is a pair
  /// with itself.
  std::span<const TrianglePair> pairs() const { return pairs_; }
  std::size_t pair_count() const { return pairs_.size(); }

 private:
  std::vector<std::uint32_t> update_mesh(std::span<const Vec3> positions,
                                         std::span<const Triangle> triangles);
  void move(std::uint32_t vertex, Vec3 to);
  std::vector<std::uint32_t> test(std::span<const std::uint32_t> changed,
                                  const RunControl& control);
  bool has_area_in_all_forms(const Triangle& t) const;
  bool intersect_in_any_form(std::uint32_t first, std::uint32_t second) const;

  OutputPositions forms_;
  CloseTriangles close_;
  // The last mesh and its self-intersections.
  std::vector<Vec3> positions_;  // in sample-index coordinates
  std::vector<Vec3> output_;     // the same in form 0
  std::vector<Triangle> triangles_;
  std::vector<TrianglePair> pairs_;  // a triangle without area is listed as a pair with itself
};

}  // namespace isoatlas::detail
