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

// A cell is at the resolution limit if its radius is this share of the distance to its site's
// farthest neighbour: then its disk contains little more than the site. (The paper stops at 1,
// where it can guarantee the aspect ratio; here every triangle is tested.)
inline constexpr float kLimitShare = 0.35f;

// min-edge applies to chords, radii are geodesic.
inline constexpr float kChordSlack = 1.25f;

/// The constraints of one refinement run: the metrics to satisfy, and the limits that have priority
/// over them.
struct RefinementTask {
  std::vector<Constraint> metrics;
  Placement placement = Placement::surface;
  std::uint32_t max_sites = kNone;
  std::uint32_t min_sites = 0;
  float min_edge = 0;
  std::optional<ShapeGoal> shape;
  float limit_share = kLimitShare;
  float useful_radius = 0;  ///< smaller disks do not reduce the error of any cell
};

/// The smallest allowed radius of a disk.
inline float min_radius(const RefinementTask& task, const SurfaceData& surface_data, CVertexId v) {
  return std::max(task.limit_share * surface_data.farthest_neighbour[v],
                  kChordSlack * task.min_edge);
}

/// The smallest radius of a disk that refinement to bounds uses.
inline float min_useful_radius(const RefinementTask& task, const SurfaceData& surface_data,
                               CVertexId v) {
  return std::max(min_radius(task, surface_data, v), task.useful_radius);
}

/// The bounds, relaxed by a factor >= 1.
std::vector<Constraint> relaxed_bounds(const std::vector<Constraint>& metrics,
                                       double relaxation = 1);

/// Makes the cells at badly shaped triangles smaller. @return whether any could be
bool shrink_cells_at_bad_triangles(MeasuredCovering& measured, const RefinementTask& task,
                                   const std::vector<DualTriangle>& triangles);

/// Inserts sites and lowers radii in rounds until a task is finished
/// (docs/theory/05-refinement.md). Use one object per level: it tracks the progress of the level.
class RefinementRounds {
 public:
  /// Refines until all bounds are satisfied as far as possible, or vertices run out. Adds its
  /// counts to `out`.
  void refine(MeasuredCovering& measured, const RefinementTask& task, RefinedLevel& out,
              const RunControl& control);

 private:
  void refine_to_bounds(MeasuredCovering& measured, const RefinementTask& task, RefinedLevel& out,
                        const RunControl& control);
  double progress_of(double worst);

  double first_worst_ = 1;  // largest excess so far
};

}  // namespace isoatlas::detail
