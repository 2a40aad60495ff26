// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/hierarchy.h"

#include <cstring>
#include <new>
#include <string>
#include <utility>

#include "core/require.h"
#include "isoatlas/error.h"

namespace isoatlas {

std::uint32_t Hierarchy::level_of(std::uint32_t vertex) const {
  for (std::uint32_t level = 0; level < levels.size(); ++level)
    if (vertex < levels[level].vertex_count) return level;
  throw Error(ErrorCode::bad_argument, "no level has a vertex " + std::to_string(vertex));
}

namespace {

const Hierarchy::Level& level_at(const Hierarchy& hierarchy, std::size_t level) {
  detail::require(level < hierarchy.levels.size(),
                  "there is no level " + std::to_string(level) + ", expected one of " +
                      std::to_string(hierarchy.levels.size()) + " levels, from 0");
  return hierarchy.levels[level];
}

}  // namespace

TriangleMesh Hierarchy::mesh(std::size_t level) const try {
  const Level& l = level_at(*this, level);
  TriangleMesh out;
  out.triangles = l.triangles;
  if (l.own_positions.empty()) {
    out.positions.assign(positions.begin(), positions.begin() + l.vertex_count);
  } else {
    out.positions = l.own_positions;
  }
  return out;
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory to copy a level");
}

MeshView Hierarchy::view(std::size_t level) const {
  const Level& l = level_at(*this, level);
  return {l.own_positions.empty() ? std::span(positions).first(l.vertex_count)
                                  : std::span(l.own_positions),
          l.triangles};
}

Hierarchy hierarchy_of(std::vector<TriangleMesh> levels) try {
  detail::require(!levels.empty(), "a hierarchy needs at least one level");
  Hierarchy out;
  out.positions = levels.back().positions;
  for (TriangleMesh& mesh : levels) {
    const std::size_t n = mesh.positions.size();
    const bool is_prefix =
        n <= out.positions.size() &&
        std::memcmp(mesh.positions.data(), out.positions.data(), n * sizeof(Vec3)) == 0;
    Hierarchy::Level& level = out.levels.emplace_back();
    level.vertex_count = static_cast<std::uint32_t>(n);
    level.triangles = std::move(mesh.triangles);
    if (!is_prefix) level.own_positions = std::move(mesh.positions);
  }
  return out;
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory for the levels");
}

}  // namespace isoatlas
