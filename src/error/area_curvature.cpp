// SPDX-License-Identifier: Apache-2.0
// Area curvature 1 (paper, 3.5): surfel areas over their projections along the normals of the
// closest triangles, as in flat shading. Ratio >= 1.
#include "error/area_ratio.h"
#include "error/metrics.h"

namespace isoatlas::detail {

double area_curvature(const CellView& cell) {
  return area_ratio(cell, [&](const ClosestPoint& p) { return cell.triangle_normal[p.triangle]; });
}

}  // namespace isoatlas::detail
