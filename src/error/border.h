// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "error/cell_view.h"

namespace isoatlas::detail {

/// Is the c-vertex on its cell's border: has it a neighbour in another cell, or is it on the surface's boundary?
inline bool is_on_border(const CellView& cell, CVertexId v) {
  if (cell.graph.on_boundary[v]) return true;
  for (const CVertexGraph::Neighbour& n : cell.graph.row(v)) {
    if (cell.cell_of[n.id] != cell.cell_of[v]) return true;
  }
  return false;
}

}  // namespace isoatlas::detail
