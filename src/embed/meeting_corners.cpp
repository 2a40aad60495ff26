// SPDX-License-Identifier: Apache-2.0
#include "embed/meeting_corners.h"

#include <algorithm>

namespace isoatlas {

std::vector<std::uint32_t> meeting_corners(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                           const RunControl& control) {
  std::vector<std::uint32_t> out;
  for (const auto& [a, b] : self_intersections(positions, triangles, {}, control)) {
    out.insert(out.end(), triangles[a].begin(), triangles[a].end());
    out.insert(out.end(), triangles[b].begin(), triangles[b].end());
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace isoatlas
