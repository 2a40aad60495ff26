// SPDX-License-Identifier: Apache-2.0
// Maximum distance from the surface (paper, 3.5), two-sided: from the cell's c-vertices to the
// mesh, and from the mesh's triangles to the surface, since a triangle that bridges a fold is near
// every c-vertex. World length.
#include <algorithm>

#include "error/metrics.h"

namespace isoatlas::detail {

double max_distance(const CellView& cell) {
  float largest = cell.from_mesh;
  for (const ClosestPoint& p : cell.closest) largest = std::max(largest, p.distance);
  return largest;
}

}  // namespace isoatlas::detail
