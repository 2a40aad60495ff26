// SPDX-License-Identifier: Apache-2.0
#include "embedding/edges_on_box.h"

#include <algorithm>
#include <utility>

#include "core/ranges.h"

namespace isoatlas::detail {

std::vector<EdgeOnBox> edges_on_box(std::span<const std::uint8_t> faces_of,
                                    std::span<const Triangle> triangles) {
  std::vector<EdgeOnBox> out;
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (faces_of[a] != 0 && faces_of[b] != 0) out.push_back({a, b, false});
    }
  }
  const auto before = [](const EdgeOnBox& a, const EdgeOnBox& b) {
    return std::pair(a.from, a.to) < std::pair(b.from, b.to);
  };
  ranges::sort(out, before);
  for (EdgeOnBox& edge : out) {
    const EdgeOnBox opposite{edge.to, edge.from, false};
    edge.is_boundary = !std::binary_search(out.begin(), out.end(), opposite, before);
  }
  return out;
}

std::vector<std::uint8_t> faces_of_vertices(std::span<const Vec3> positions, const BoxFaces& box) {
  std::vector<std::uint8_t> out;
  out.reserve(positions.size());
  for (const Vec3& p : positions) out.push_back(static_cast<std::uint8_t>(box.containing(p)));
  return out;
}

}  // namespace isoatlas::detail
