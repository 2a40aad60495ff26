// SPDX-License-Identifier: Apache-2.0
#include "stored/archive.h"

#include <algorithm>

namespace isoatlas::detail {

void require_corners_in_range(const Hierarchy& hierarchy, std::string_view name) {
  const ArchiveReader rules({}, name);
  rules.require(hierarchy.parent.empty() || hierarchy.parent.size() == hierarchy.positions.size());
  for (const std::uint32_t parent : hierarchy.parent)
    rules.require(parent < hierarchy.positions.size());
  for (const Hierarchy::Level& level : hierarchy.levels) {
    const std::size_t count =
        level.own_positions.empty() ? hierarchy.positions.size() : level.own_positions.size();
    rules.require(level.vertex_count <= count);
    rules.require(level.cap_triangles <= level.triangles.size());
    rules.require(level.distance.empty() || level.distance.size() == level.vertex_count);
    for (const Triangle& triangle : level.triangles)
      rules.require(*std::max_element(triangle.begin(), triangle.end()) < level.vertex_count);
  }
}

}  // namespace isoatlas::detail
