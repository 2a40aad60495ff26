// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "error/metrics.h"
#include "isoatlas/certificate.h"
#include "isoatlas/refine.h"
#include "optimize/shape_optimizer.h"

namespace isoatlas::detail {

struct LevelFigures {
  std::array<MetricSummary, kMetricCount> metrics{};
  std::vector<ConstraintResult> constraints;  ///< in the order given
  std::vector<float> distance;                ///< per cell, its max-distance
  std::optional<double> distance_at_most;     ///< a proved two-sided bound
};

struct RefinedLevel {
  /// max-vertices has priority and no level with more vertices than the previous one satisfies it:
  /// the level is the previous one again, and only `figures` is new.
  bool unchanged_from_previous_level = false;
  std::vector<Triangle> triangles;
  CertificateReport certificate;
  LevelFigures figures;
  /// cells that violate a bound and cannot become smaller, with their excess; worst first
  std::vector<std::pair<CellId, double>> at_limit;
  ShapeReport shape;
  std::size_t rounds = 0;
  std::size_t sites_for_intersections = 0;  ///< sites inserted to resolve intersections
  bool vertex_limit_reached = false;        ///< a limit on vertices ended refinement
};

}  // namespace isoatlas::detail
