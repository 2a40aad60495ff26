// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "geometry/close_triangles.h"
#include "geometry/written_positions.h"

namespace isoatlas::detail {

/// The self-intersections of a mesh that changes, and its triangles without area, in the coordinates that files have. Call update() for
/// each new version of the mesh: only triangles that changed are tested again.
class IntersectionTracker {
 public:
  explicit IntersectionTracker(WrittenPositions written = {}) : written_(std::move(written)), close_(written_.most_rounding()) {}

  /// Tests all forms of the positions at once.
  /// @param positions  in sample indices
  /// @param triangles  one that is what it was has the number that it had, or counts as changed
  /// @return the corners of all triangles that intersect or have no area in any of the forms, sorted
  /// @cost   as self_intersections() the first time; then what is near triangles that changed, and a comparison with the last mesh
  std::vector<std::uint32_t> update(std::span<const Vec3> positions, std::span<const Triangle> triangles, const RunControl& control);

  /// The same where only these vertices have moved since the last mesh.
  /// @param at       where they are, one by one
  /// @param changed  the triangles with other corners or a corner that moved, sorted
  /// @param corners  of these, one by one
  /// @cost   what is near triangles that changed
  std::vector<std::uint32_t> update(std::span<const std::uint32_t> vertices, std::span<const Vec3> at,
                                    std::span<const std::uint32_t> changed, std::span<const Triangle> corners, const RunControl& control);

  /// Of each pair in the last mesh the largest corner, all six if the largest has no size; sorted.
  std::vector<std::uint32_t> largest_corners(std::span<const float> size_of_vertex) const;

  std::size_t pair_count() const { return pairs_.size(); }  ///< in the last mesh

 private:
  std::vector<std::uint32_t> take_mesh(std::span<const Vec3> positions, std::span<const Triangle> triangles);
  void move(std::uint32_t vertex, Vec3 to);
  std::vector<std::uint32_t> test(std::span<const std::uint32_t> changed, const RunControl& control);
  bool has_area_in_all_forms(const Triangle& t) const;
  bool intersect_in_any_form(std::uint32_t first, std::uint32_t second) const;

  WrittenPositions written_;
  CloseTriangles close_;
  // The last mesh and its self-intersections.
  std::vector<Vec3> positions_;  // in sample indices
  std::vector<Vec3> in_space_;   // form 0
  std::vector<Triangle> triangles_;
  std::vector<TrianglePair> pairs_;  // a triangle without area is a pair with itself
};

}  // namespace isoatlas::detail
