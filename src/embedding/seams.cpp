// SPDX-License-Identifier: Apache-2.0
#include "embedding/seams.h"

#include <algorithm>
#include <array>

#include "core/ranges.h"
#include "embedding/edges_on_box.h"

namespace isoatlas::detail {

namespace {

using Edge = std::array<CVertexId, 2>;  // from, to

std::vector<Edge> sides_on_shared_faces(const SurfaceComplex& surface) {
  std::vector<Edge> out;
  for (const BoundarySide& side : surface.boundary) {
    if (surface.on_boundary[side.from] == kOnSharedFace &&
        surface.on_boundary[side.to] == kOnSharedFace)
      out.push_back({side.from, side.to});
  }
  ranges::sort(out);
  return out;
}

}  // namespace

std::vector<std::uint32_t> vertices_that_prevent_seams(std::span<const Vec3> positions,
                                                       std::span<const Triangle> triangles,
                                                       std::span<const CVertexId> sites,
                                                       const SurfaceComplex& surface,
                                                       const SharedBox& shared) {
  const std::vector<std::uint8_t> faces_of = faces_of_vertices(positions, shared.box);
  const std::vector<Edge> seam = sides_on_shared_faces(surface);
  std::vector<std::uint32_t> out;
  for (const EdgeOnBox& edge : edges_on_box(faces_of, triangles)) {
    if ((faces_of[edge.from] & faces_of[edge.to] & shared.faces) == 0) continue;
    // Another boundary edge cuts off a part of another face of the block.
    if (edge.is_boundary &&
        std::binary_search(seam.begin(), seam.end(), Edge{sites[edge.from], sites[edge.to]}))
      continue;
    out.push_back(edge.from);
    out.push_back(edge.to);
  }
  for (const auto& [a, b, c] : triangles) {
    if ((faces_of[a] & faces_of[b] & faces_of[c] & shared.faces) != 0)
      out.insert(out.end(), {a, b, c});
  }
  ranges::sort_unique(out);
  return out;
}

}  // namespace isoatlas::detail
