// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "isoatlas/mesh.h"

namespace isoatlas::detail::io {

constexpr std::uint32_t kIndexOutOfRange = std::numeric_limits<std::uint32_t>::max();

/// An index from a file as a vertex index. What does not fit becomes kIndexOutOfRange, which no
/// mesh has: read_mesh's check of all indices reports it.
inline std::uint32_t vertex_index(std::int64_t index) {
  return index >= 0 && index < std::int64_t{kIndexOutOfRange} ? static_cast<std::uint32_t>(index)
                                                              : kIndexOutOfRange;
}

/// Cuts the polygons of a file into triangles. Fewer than three corners (points, lines) add
/// nothing.
class PolygonCutter {
 public:
  explicit PolygonCutter(TriangleMesh& mesh) : mesh_(mesh) {}

  /// Adds a polygon as triangles around its first corner.
  void append(std::span<const std::uint32_t> corners);

  /// Replaces the fans of concave polygons by triangles inside them. Call it when all positions are
  /// known.
  void cut_concave();

 private:
  struct Polygon {
    std::size_t first_triangle = 0, first_corner = 0, corner_count = 0;
  };

  TriangleMesh& mesh_;
  std::vector<Polygon> polygons_ = {};       // of more than three corners
  std::vector<std::uint32_t> corners_ = {};  // of all of these
};

}  // namespace isoatlas::detail::io
