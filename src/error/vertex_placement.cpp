// SPDX-License-Identifier: Apache-2.0
#include "error/vertex_placement.h"

#include "core/parallel.h"
#include "core/vector_math.h"
#include "embedding/subdivide.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kVerticesPerChunk = 2048;  // vertices, of a parallel loop

}  // namespace

Vec3 base_position(const SurfaceComplex& complex, const VertexPlacement& placement, CellId c) {
  return displaced_position(complex, placement.anchor[c],
                            placement.displacement.empty() ? Vec3{} : placement.displacement[c]);
}

Vec3 vertex_position(const SurfaceComplex& complex, const Surfels& surfels,
                     const VertexPlacement& placement, CellId c) {
  const Vec3 p = base_position(complex, placement, c);
  if (placement.normal_offset.empty()) return p;
  const Vec3 s = complex.spacing, n = surfels.normal[placement.anchor[c]];
  const auto d = static_cast<double>(placement.normal_offset[c]);
  return p + Vec3{d * n.x / s.x, d * n.y / s.y, d * n.z / s.z};
}

std::vector<Vec3> vertex_positions(const SurfaceComplex& complex, const Surfels& surfels,
                                   const VertexPlacement& placement) {
  std::vector<Vec3> out(placement.anchor.size());
  for_each_index(out.size(), kVerticesPerChunk, [&](std::size_t c) {
    out[c] = vertex_position(complex, surfels, placement, static_cast<CellId>(c));
  });
  return out;
}

std::vector<ShapeObstacle> obstacles(const VertexPlacement& placement,
                                     const AdaptiveSurface& surface, CellId earlier) {
  std::vector<ShapeObstacle> out;
  out.reserve(placement.anchor.size());
  for (CellId c = 0; c < placement.anchor.size(); ++c) {
    out.push_back(c < earlier                                ? ShapeObstacle::earlier_level
                  : !placement.is_movable(c)                 ? ShapeObstacle::self_intersection
                  : !surface.is_movable(placement.anchor[c]) ? ShapeObstacle::multi_sheet
                                                             : ShapeObstacle::none);
  }
  return out;
}

}  // namespace isoatlas::detail
