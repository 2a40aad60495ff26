// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/hierarchy.h"

#include <string>

#include "isoatlas/error.h"

namespace isoatlas {

std::uint32_t Hierarchy::level_of(std::uint32_t vertex) const {
  for (std::uint32_t level = 0; level < levels.size(); ++level)
    if (vertex < levels[level].vertex_count) return level;
  throw Error(ErrorCode::bad_argument, "no level has a vertex " + std::to_string(vertex));
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
