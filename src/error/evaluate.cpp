// SPDX-License-Identifier: Apache-2.0
#include "error/metrics.h"
#include "isoatlas/error.h"

namespace isoatlas::detail {

double evaluate(Quantity metric, const CellView& cell) {
  switch (metric) {
    case Quantity::max_distance:
      return max_distance(cell);
    case Quantity::mean_distance:
      return mean_distance(cell);
    case Quantity::area_curvature:
      return area_curvature(cell);
    case Quantity::area_curvature_smooth:
      return area_curvature_smooth(cell);
    case Quantity::geodesic_ratio:
      return geodesic_ratio(cell);
    case Quantity::normal_angle:
      return normal_angle(cell);
    default:
      throw Error(ErrorCode::bad_argument, std::string(name(metric)) + " is not a metric");
  }
}

}  // namespace isoatlas::detail
