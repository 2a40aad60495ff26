// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "error/measured_covering.h"
#include "isoatlas/refine.h"
#include "levels/refined_level.h"
#include "optimize/shape_optimizer.h"

namespace isoatlas::detail {

// A cell is at the resolution limit when its radius is this share of the distance to its site's farthest neighbour: then its disk
// holds hardly more than its site. (The paper stops at 1, where it can promise the aspect ratio; here every triangle is looked at.)
inline constexpr float kLimitShare = 0.35f;

// min-edge is asked of chords, radii are geodesic.
inline constexpr float kChordSlack = 1.25f;

/// What one stretch of work is about: the metrics to meet, within limits that come before them.
struct RefinementTask {
  std::vector<Constraint> metrics;
  Placement placement = Placement::surface;
  std::uint32_t most_sites = kNone;
  std::uint32_t least_sites = 0;
  float shortest_edge = 0;
  std::optional<ShapeGoal> shape;
  float limit_share = kLimitShare;
  float useful_radius = 0;  ///< disks smaller than this bring no cell nearer to its bounds
};

/// The smallest radius that a disk may get.
inline float least_radius(const RefinementTask& task, const SurfaceData& surface_data, CVertexId v) {
  return std::max(task.limit_share * surface_data.farthest_neighbour[v], kChordSlack * task.shortest_edge);
}

/// The smallest radius that a disk may get for the sake of bounds.
inline float least_useful_radius(const RefinementTask& task, const SurfaceData& surface_data, CVertexId v) {
  return std::max(least_radius(task, surface_data, v), task.useful_radius);
}

/// What is asked for, bounds so many times as generous.
std::vector<Constraint> demands_of(const std::vector<Constraint>& metrics, double generosity = 1);

/// Makes the cells at badly shaped triangles smaller. @return whether any could be
bool make_smaller_at_bad_triangles(MeasuredCovering& work, const RefinementTask& task, const std::vector<DualTriangle>& triangles);

/// Adds sites and lowers radii in rounds until a task is done (docs/theory/05-refinement.md). One object for each level: it knows how far
/// the level is.
class RefinementRounds {
 public:
  /// Until the task is done as far as it can be, or vertices run out; what was done is added to `out`.
  void work(MeasuredCovering& work, const RefinementTask& task, RefinedLevel& out, const RunControl& control);

 private:
  void meet(MeasuredCovering& work, const RefinementTask& task, RefinedLevel& out, const RunControl& control);
  double done_of_meeting(double worst);

  double first_worst_ = 1;  // the largest excess so far
};

}  // namespace isoatlas::detail
