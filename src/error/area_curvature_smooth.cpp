// SPDX-License-Identifier: Apache-2.0
// Area curvature 2 (paper, 3.5): like area curvature 1, with the normal interpolated between the
// closest triangle's corners, as in smooth shading. Ratio >= 1.
#include "error/area_ratio.h"
#include "error/metrics.h"

namespace isoatlas::detail {

double area_curvature_smooth(const CellView& cell) {
  return area_ratio(cell, [&](const ClosestPoint& p) {
    const std::array<CellId, 3>& at = cell.triangles[p.triangle];
    Vec3 sum;
    for (std::size_t k = 0; k < 3; ++k)
      sum = sum + static_cast<double>(p.weight[k]) * cell.vertex_normal[at[k]];
    return normalized(sum);
  });
}

}  // namespace isoatlas::detail
