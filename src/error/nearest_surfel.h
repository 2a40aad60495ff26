// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "complex/c_vertex_graph.h"
#include "core/vector_math.h"
#include "error/surfels.h"

namespace isoatlas::detail {

struct NearestSurfel {
  CVertexId id;
  double squared_distance;
};

/// Follows decreasing distance in G from `start` to a c-vertex none of whose neighbours is nearer
/// to p. If p is near the surface, this is the nearest c-vertex on the sheet of `start`. O(length
/// of the path).
inline NearestSurfel walk_to_nearest(const Surfels& surfels, const CVertexGraph& graph,
                                     CVertexId start, Vec3 p) {
  NearestSurfel at{start, squared_length(surfels.point[start] - p)};
  for (CVertexId from = kNone; from != at.id;) {
    from = at.id;
    for (const CVertexGraph::Neighbour& n : graph.row(from)) {
      const double d = squared_length(surfels.point[n.id] - p);
      if (d < at.squared_distance) at = {n.id, d};
    }
  }
  return at;
}

}  // namespace isoatlas::detail
