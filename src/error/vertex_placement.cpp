// SPDX-License-Identifier: Apache-2.0
#include "error/vertex_placement.h"

#include "core/parallel.h"
#include "core/vector_math.h"
#include "embedding/subdivide.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kPerPiece = 2048;  // vertices, of a parallel loop

}  // namespace

Vec3 base_position(const SurfaceComplex& complex, const VertexPlacement& places, CellId c) {
  return displaced_position(complex, places.anchor[c], places.shift.empty() ? Vec3{} : places.shift[c]);
}

Vec3 vertex_position(const SurfaceComplex& complex, const Surfels& surfels, const VertexPlacement& places, CellId c) {
  const Vec3 p = base_position(complex, places, c);
  if (places.offset.empty()) return p;
  const Vec3 s = complex.spacing, n = surfels.normal[places.anchor[c]];
  const auto d = static_cast<double>(places.offset[c]);
  return p + Vec3{d * n.x / s.x, d * n.y / s.y, d * n.z / s.z};
}

std::vector<Vec3> vertex_positions(const SurfaceComplex& complex, const Surfels& surfels, const VertexPlacement& places) {
  std::vector<Vec3> out(places.anchor.size());
  for_each_index(out.size(), kPerPiece, [&](std::size_t c) { out[c] = vertex_position(complex, surfels, places, static_cast<CellId>(c)); });
  return out;
}

std::vector<ShapeObstacle> obstacles(const VertexPlacement& places, const AdaptiveSurface& surface, CellId earlier) {
  std::vector<ShapeObstacle> out;
  out.reserve(places.anchor.size());
  for (CellId c = 0; c < places.anchor.size(); ++c) {
    out.push_back(c < earlier                             ? ShapeObstacle::earlier_level
                  : !places.may_move(c)                   ? ShapeObstacle::self_intersection
                  : !surface.is_movable(places.anchor[c]) ? ShapeObstacle::crowded
                                                          : ShapeObstacle::none);
  }
  return out;
}

}  // namespace isoatlas::detail
