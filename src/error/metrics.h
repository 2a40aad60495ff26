// SPDX-License-Identifier: Apache-2.0
// The paper's error metrics (section 3.5), each in a file of its own name.
#pragma once

#include "error/cell_view.h"
#include "isoatlas/refine.h"

namespace isoatlas::detail {

double max_distance(const CellView& cell);
double mean_distance(const CellView& cell);
double area_curvature(const CellView& cell);
double area_curvature_smooth(const CellView& cell);
double geodesic_ratio(const CellView& cell);
double normal_angle(const CellView& cell);

/// One of the metrics above. @pre is_metric(metric)
double evaluate(Quantity metric, const CellView& cell);

/// Whether the metric uses CellView::closest.
constexpr bool needs_closest(Quantity metric) { return metric <= Quantity::area_curvature_smooth; }

}  // namespace isoatlas::detail
