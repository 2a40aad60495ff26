// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "error/cell_view.h"

namespace isoatlas::detail {

/// Whether the c-vertex is on the boundary of its Voronoi cell: it has a neighbour in another
/// Voronoi cell, or is on the boundary of the surface.
inline bool is_on_cell_boundary(const CellView& cell, CVertexId v) {
  if (cell.graph.on_boundary[v]) return true;
  for (const CVertexGraph::Neighbour& n : cell.graph.row(v)) {
    if (cell.cell_of[n.id] != cell.cell_of[v]) return true;
  }
  return false;
}

}  // namespace isoatlas::detail
