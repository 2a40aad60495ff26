// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "error/level_mesh.h"
#include "isoatlas/refine.h"

namespace isoatlas::detail {

/// What the constraints other than metrics are about.
struct MeshExtent {
  std::size_t vertices = 0;
  std::size_t c_vertices = 0;  ///< of the surface
  double shortest_edge = 0, longest_edge = 0;
  std::vector<double> aspects;  ///< per triangle, shortest over longest edge
};

MeshExtent extent_of(const LevelMesh& mesh);

/// What the work on a level ran into.
struct Obstacles {
  const MeshExtent* before = nullptr;  ///< the level before; none for the coarse level
  bool before_is_coarse = false;
  bool vertices_ran_out = false;   ///< max-vertices ended the work
  bool edges_in_the_way = false;   ///< min-edge keeps cells that are over a bound from becoming smaller
  std::size_t cells_at_limit = 0;  ///< cells over a bound that are as small as cells can be
};

/// What became of the constraints, in their order, and what stood in the way of those that are not met.
std::vector<ConstraintResult> judge(const LevelGoal& goal, const MeshExtent& mesh, const std::array<MetricSummary, kMetricCount>& metrics,
                                    const Obstacles& obstacles);

}  // namespace isoatlas::detail
