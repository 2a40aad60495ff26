// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "error/level_mesh.h"
#include "isoatlas/refine.h"

namespace isoatlas::detail {

/// The measures of a mesh for constraints other than metrics.
struct MeshStatistics {
  std::size_t vertices = 0;
  std::size_t c_vertices = 0;  ///< number of c-vertices of the surface
  double shortest_edge = 0, longest_edge = 0;
  std::vector<double> aspects;  ///< per triangle, shortest over longest edge
};

MeshStatistics mesh_statistics(const LevelMesh& mesh);

/// What prevented constraints from being satisfied while a level was made.
struct Obstacles {
  const MeshStatistics* previous = nullptr;  ///< of the previous level; none for the coarse level
  bool previous_is_coarse = false;
  bool vertex_limit_reached = false;  ///< the constraint max-vertices ended refinement
  bool blocked_by_min_edge =
      false;  ///< min-edge prevents cells that violate a bound from becoming smaller
  std::size_t cells_at_limit =
      0;  ///< number of cells that violate a bound and cannot become smaller
};

/// The largest value of a caller's metric in the cells of a mesh.
using CustomMaximum = std::function<double(const CustomMetric&)>;

/// The results of the constraints, in their order, with the reason for each that is violated.
std::vector<ConstraintResult> evaluate_constraints(
    const LevelGoal& goal, const MeshStatistics& mesh,
    const std::array<MetricSummary, kMetricCount>& metrics, const CustomMaximum& custom_maximum,
    const Obstacles& obstacles);

}  // namespace isoatlas::detail
