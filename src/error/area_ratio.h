// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>

#include "core/vector_math.h"
#include "error/cell_view.h"

namespace isoatlas::detail {

inline bool is_at_vertex(const ClosestPoint& p) {
  return p.distance == 0 && (p.weight[0] == 1 || p.weight[1] == 1 || p.weight[2] == 1);
}

/// Both area curvatures (paper, 3.5): the area of the cell's surfels divided by these areas
/// projected along the mesh's normals,
///   K = sum A / sum A cos(N, Nt).
/// Infinite if the projected sum is not positive. A c-vertex at which a mesh vertex is placed lies
/// on several triangles, none of which is its own, so it does not count.
/// @param normal_at  returns the unit normal Nt at a ClosestPoint
template <class NormalAt>
double area_ratio(const CellView& cell, NormalAt normal_at) {
  double area = 0, projected = 0;
  for (std::size_t i = 0; i < cell.c_vertices.size(); ++i) {
    const CVertexId v = cell.c_vertices[i];
    if (is_at_vertex(cell.closest[i])) continue;
    area += cell.surfels.area[v];
    projected += cell.surfels.area[v] * dot(cell.surfels.normal[v], normal_at(cell.closest[i]));
  }
  if (area <= 0) return 1;
  if (projected <= 0) return std::numeric_limits<double>::infinity();
  return std::max(1.0, area / projected);
}

}  // namespace isoatlas::detail
