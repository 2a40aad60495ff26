// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "isoatlas/mesh.h"

namespace isoatlas::detail::io {

constexpr std::uint32_t kIndexOutOfRange = std::numeric_limits<std::uint32_t>::max();

/// Converts an index from a file to a vertex index. An index that does not fit becomes
/// kIndexOutOfRange, which is out of range in every mesh, so read_mesh reports it.
inline std::uint32_t vertex_index(std::int64_t index) {
  return index >= 0 && index < std::int64_t{kIndexOutOfRange} ? static_cast<std::uint32_t>(index)
                                                              : kIndexOutOfRange;
}

/// Cuts the polygons of a file into triangles. Polygons of fewer than three corners (points, lines)
/// add no triangles.
class PolygonCutter {
 public:
  explicit PolygonCutter(TriangleMesh& mesh) : mesh_(mesh) {}

  /// Adds a polygon as a fan of triangles around its first corner.
  void append(std::span<const std::uint32_t> corners);

  /// Replaces the fans of concave polygons by triangles inside the polygons. Call it when all
  /// positions are known.
  void cut_concave();

 private:
  struct Polygon {
    std::size_t first_triangle = 0, first_corner = 0, corner_count = 0;
  };

  TriangleMesh& mesh_;
  std::vector<Polygon> polygons_ = {};       // those of more than three corners
  std::vector<std::uint32_t> corners_ = {};  // corners of all these polygons
};

}  // namespace isoatlas::detail::io
