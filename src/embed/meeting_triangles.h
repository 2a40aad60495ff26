// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "embed/written_positions.h"
#include "isoatlas/self_intersections.h"

namespace isoatlas {

/// The self-intersections of a mesh, and its triangles without area, in the coordinates that files have. Call update() for each new
/// version of the mesh: only triangles that changed are tested again.
class MeetingTriangles {
 public:
  explicit MeetingTriangles(WrittenPositions written = {}) : written_(std::move(written)) {}

  /// Tests all forms of the positions at once.
  /// @param positions  in sample indices
  /// @return the corners of all triangles that intersect or have no area in any of the forms, sorted
  /// @cost   as self_intersections() the first time; then one pass over the mesh, plus what is near triangles that are new or have a corner
  ///         that moved
  std::vector<std::uint32_t> update(std::span<const Vec3> positions, std::span<const Triangle> triangles, const RunControl& control);

  /// Of each pair in the last mesh the largest corner, all six if the largest has no size; sorted.
  std::vector<std::uint32_t> largest_corners(std::span<const float> size_of_vertex) const;

  std::size_t pairs() const { return pairs_.size(); }  ///< of the last mesh

 private:
  // A set of triangles. contains() expects a triangle with its smallest corner first.
  class TriangleSet {
   public:
    TriangleSet() = default;
    TriangleSet(std::span<const Triangle> triangles, std::size_t vertices);
    bool contains(const Triangle& t) const;

   private:
    std::vector<std::uint32_t> first_{0};  // per vertex, in triangles_, those with that smallest corner
    std::vector<Triangle> triangles_;
  };
  std::vector<std::uint32_t> take_mesh(std::span<const Vec3> positions, std::span<const Triangle> triangles);
  bool has_area_in_all_forms(const Triangle& t) const;
  bool intersect_in_any_form(const Triangle& a, const Triangle& b) const;

  WrittenPositions written_;
  // The mesh of the last update(), and its self-intersections.
  std::vector<Vec3> positions_;    // in sample indices
  std::vector<Vec3> in_space_;     // form 0
  std::vector<Triangle> list_;     // as they were given
  TriangleSet triangles_;
  std::vector<std::uint8_t> stayed_;  // per vertex, 1 if it did not move in the last update()
  std::vector<std::pair<Triangle, Triangle>> pairs_;  // a triangle without area is a pair with itself
};

}  // namespace isoatlas
