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
  explicit MeetingTriangles(WrittenPositions written = {}) : written_(std::move(written)), forms_(written_.form_count()) {}

  /// Tests one form of the positions after the other, and stops at the first form with self-intersections.
  /// @param positions  in sample indices
  /// @return the corners of all such triangles, sorted
  /// @cost   as self_intersections() for each form the first time; then one pass over the mesh for each, plus what is near triangles that
  ///         are new or have a corner that moved
  std::vector<std::uint32_t> update(std::span<const Vec3> positions, std::span<const Triangle> triangles, const RunControl& control);

  /// Of each pair in the last mesh the largest corner, all six if the largest has no size; sorted.
  std::vector<std::uint32_t> largest_corners(std::span<const float> size_of_vertex) const;

  std::size_t pairs() const { return forms_[last_].pairs.size(); }  ///< of the last mesh

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
  // The mesh of the last update(), with its positions in one form, and its self-intersections.
  struct Form {
    std::vector<Vec3> positions;
    std::vector<Triangle> list;  // as they were given
    TriangleSet triangles;
    std::vector<std::pair<Triangle, Triangle>> pairs;  // a triangle without area is a pair with itself

    void update(std::vector<Vec3> moved, std::span<const Triangle> given, const RunControl& control);
    std::vector<std::uint8_t> vertices_that_stayed(std::span<const Vec3> moved) const;  // per vertex, since the last update()
    std::vector<std::uint32_t> fresh(std::span<const Vec3> moved, std::span<const Triangle> given) const;
  };

  WrittenPositions written_;
  std::vector<Form> forms_;
  std::size_t last_ = 0;  // the form that was looked at last
};

}  // namespace isoatlas
