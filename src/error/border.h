// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "error/cell_view.h"

namespace isoatlas::detail {

/// Whether the c-vertex is on its cell's border: it has a neighbour in another cell or is on the
/// surface's boundary.
inline bool is_on_border(const CellView& cell, CVertexId v) {
  if (cell.graph.on_boundary[v]) return true;
  for (const CVertexGraph::Neighbour& n : cell.graph.row(v)) {
    if (cell.cell_of[n.id] != cell.cell_of[v]) return true;
  }
  return false;
}

}  // namespace isoatlas::detail
