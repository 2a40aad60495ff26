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

/// Where the vertices of a level are placed.
struct VertexPlacement {
  std::vector<CVertexId> anchor;  ///< per cell, the c-vertex at which its vertex is placed: the
                                  ///< site, or a better one near it
  std::vector<float> normal_offset{};  ///< per cell, the distance from there along the surface's
                                       ///< normal, for this level only; empty: all 0
  std::vector<Vec3> displacement{};    ///< per cell, metric displacement from the anchor, for all
                                       ///< levels; empty: all 0
  /// per cell: 1 if its triangles are fixed to those of the dual, 3 if the vertex is fixed as well;
  /// missing: 0
  std::vector<std::uint8_t> fixed{};

  bool is_movable(CellId c) const { return c >= fixed.size() || fixed[c] < 3; }
  bool is_flippable(CellId c) const { return c >= fixed.size() || fixed[c] == 0; }
  /// The point of a vertex without its normal offset.
  Vec3 base_point(const Surfels& surfels, CellId c) const {
    const Vec3 p = surfels.point[anchor[c]];
    return displacement.empty()
               ? p
               : Vec3{p.x + displacement[c].x, p.y + displacement[c].y, p.z + displacement[c].z};
  }
  Vec3 point(const Surfels& surfels, CellId c) const {
    const Vec3 p = base_point(surfels, c);
    if (normal_offset.empty()) return p;
    const auto d = static_cast<double>(normal_offset[c]);
    const Vec3 n = surfels.normal[anchor[c]];
    return {p.x + d * n.x, p.y + d * n.y, p.z + d * n.z};
  }
};

/// base_point() and point() in sample-index coordinates, bit for bit as they are written.
/// Intersection tests use these.
Vec3 base_position(const SurfaceComplex& complex, const VertexPlacement& placement, CellId c);
Vec3 vertex_position(const SurfaceComplex& complex, const Surfels& surfels,
                     const VertexPlacement& placement, CellId c);
std::vector<Vec3> vertex_positions(const SurfaceComplex& complex, const Surfels& surfels,
                                   const VertexPlacement& placement);

/// Per vertex, the reason why it cannot be moved.
/// @param earlier  number of vertices of earlier levels
std::vector<ShapeObstacle> obstacles(const VertexPlacement& placement,
                                     const AdaptiveSurface& surface, CellId earlier);

}  // namespace isoatlas::detail
