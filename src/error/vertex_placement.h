// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "complex/partition.h"
#include "complex/surface_complex.h"
#include "embedding/adaptive_surface.h"
#include "error/surfels.h"
#include "isoatlas/refine.h"

namespace isoatlas::detail {

/// Where the vertices of a level sit, whatever the level. Points have the spacing applied, positions are in sample indices.
struct VertexPlacement {
  std::vector<CVertexId> anchor;         ///< per cell, the c-vertex at whose point it sits: its site, or a better one near by
  std::vector<float> offset{};           ///< per cell, how far from there along the surface's normal, in this level; empty: not at all
  std::vector<Vec3> shift{};             ///< per cell, how far from its c-vertex, in all levels; spacing applied; empty: not at all
  std::vector<std::uint8_t> given_up{};  ///< per cell, 1 if its triangles stay the dual's, 3 if it stays at its site, too; missing: 0

  bool may_move(CellId c) const { return c >= given_up.size() || given_up[c] < 3; }
  bool may_flip(CellId c) const { return c >= given_up.size() || given_up[c] == 0; }
  /// Where it sits in all levels, but for what balancing does in one.
  Vec3 base(const Surfels& surfels, CellId c) const {
    const Vec3 p = surfels.point[anchor[c]];
    return shift.empty() ? p : Vec3{p.x + shift[c].x, p.y + shift[c].y, p.z + shift[c].z};
  }
  Vec3 point(const Surfels& surfels, CellId c) const {
    const Vec3 p = base(surfels, c);
    if (offset.empty()) return p;
    const auto d = static_cast<double>(offset[c]);
    const Vec3 n = surfels.normal[anchor[c]];
    return {p.x + d * n.x, p.y + d * n.y, p.z + d * n.z};
  }
};

/// base() and point() as positions, to the last bit as they are written: whether triangles intersect is asked of these.
Vec3 base_position(const SurfaceComplex& complex, const VertexPlacement& places, CellId c);
Vec3 vertex_position(const SurfaceComplex& complex, const Surfels& surfels, const VertexPlacement& places, CellId c);
std::vector<Vec3> vertex_positions(const SurfaceComplex& complex, const Surfels& surfels, const VertexPlacement& places);

/// Per vertex, what keeps it where it is.
/// @param earlier  how many vertices are those of earlier levels
std::vector<ShapeObstacle> obstacles(const VertexPlacement& places, const AdaptiveSurface& surface, CellId earlier);

}  // namespace isoatlas::detail
