// SPDX-License-Identifier: Apache-2.0
// Average distance from the surface (paper, 3.5): mean over the cell's c-vertices of the distance
// to the mesh. World length.
#include "error/metrics.h"

namespace isoatlas::detail {

double mean_distance(const CellView& cell) {
  double sum = 0;
  for (const ClosestPoint& p : cell.closest) sum += p.distance;
  return cell.closest.empty() ? 0 : sum / static_cast<double>(cell.closest.size());
}

}  // namespace isoatlas::detail
