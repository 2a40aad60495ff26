// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "isoatlas/self_intersections.h"

namespace isoatlas {

/// The triangles of a mesh that meet others where they should not, mesh after mesh: only what is new is looked at again.
class MeetingTriangles {
 public:
  /// @return the corners of all such triangles, sorted
  /// @cost   as self_intersections() the first time; then one pass over the mesh, plus what is near triangles that are new or have a
  ///         corner that moved
  std::vector<std::uint32_t> update(std::span<const Vec3> positions, std::span<const Triangle> triangles, const RunControl& control);

  /// Per triangle, 1 if it is new since the last update() or has a corner that moved.
  std::vector<std::uint8_t> fresh(std::span<const Vec3> positions, std::span<const Triangle> triangles) const;

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
  std::vector<std::uint8_t> vertices_that_stayed(std::span<const Vec3> positions) const;  ///< per vertex, since the last update()

  std::vector<Vec3> positions_;
  std::vector<Triangle> list_;  // as they were given
  TriangleSet triangles_;
  std::vector<std::pair<Triangle, Triangle>> pairs_;
};

}  // namespace isoatlas
