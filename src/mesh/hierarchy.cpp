// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/hierarchy.h"

namespace isoatlas {

std::uint32_t Hierarchy::level_of(std::uint32_t vertex) const {
  std::uint32_t level = 0;
  while (vertex >= levels[level].vertex_count) ++level;
  return level;
}

TriangleMesh Hierarchy::mesh(std::size_t level) const {
  const Level& l = levels.at(level);
  TriangleMesh out;
  out.triangles = l.triangles;
  if (l.placed.empty()) {
    out.positions.assign(positions.begin(), positions.begin() + l.vertex_count);
  } else {
    out.positions = l.placed;
  }
  return out;
}

}  // namespace isoatlas
