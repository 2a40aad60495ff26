// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "isoatlas/mesh.h"

namespace isoatlas::io {

constexpr std::uint32_t kIndexOutOfRange = std::numeric_limits<std::uint32_t>::max();

/// An index from a file as a vertex index. What does not fit becomes kIndexOutOfRange, which no mesh has:
/// read_mesh's check of all indices reports it.
inline std::uint32_t vertex_index(std::int64_t index) {
  return index >= 0 && index < std::int64_t{kIndexOutOfRange} ? static_cast<std::uint32_t>(index) : kIndexOutOfRange;
}

/// Adds a polygon as triangles around its first corner. Fewer than three corners (points, lines) add nothing.
inline void append_polygon(TriangleMesh& mesh, const std::vector<std::uint32_t>& corners) {
  for (std::size_t i = 2; i < corners.size(); ++i) {
    mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
  }
}

}  // namespace isoatlas::io
