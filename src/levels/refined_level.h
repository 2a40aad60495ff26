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
  std::optional<double> distance_at_most;     ///< proved, of the mesh and of the isosurface
};

struct RefinedLevel {
  /// max-vertices comes first and no level with more vertices than the one before has few enough: it is that one again, and only
  /// `figures` say anything new.
  bool is_the_one_before = false;
  std::vector<Triangle> triangles;
  CertificateReport certificate;
  LevelFigures figures;
  std::vector<std::pair<CellId, double>> at_limit;  ///< cells over a bound that cannot be made smaller, and by how much; worst first
  ShapeReport shape;
  std::size_t rounds = 0;
  std::size_t parting_sites = 0;  ///< added where triangles met others
  bool vertices_ran_out = false;  ///< a limit on vertices ended the work
};

}  // namespace isoatlas::detail
