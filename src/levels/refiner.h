// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "complex/coarsen.h"
#include "embedding/adaptive_surface.h"
#include "error/measured_covering.h"
#include "geometry/intersection_tracker.h"
#include "isoatlas/refine.h"
#include "levels/judge.h"
#include "levels/refined_level.h"
#include "levels/rounds.h"
#include "optimize/shape_optimizer.h"

namespace isoatlas::detail {

/// Stage two: makes a covering finer where metrics ask for it, level by level (paper, 3.4 and figure 8). Lengths are in voxels.
///
/// While cells are large it works on the coarser complex, then steps down to the surface itself; sites keep their vertices. In
/// every round the worst cells get a new site where they are farthest from the mesh, or a smaller radius; what changed is covered,
/// certified and measured again.
class Refiner {
 public:
  /// What level 0 is.
  struct Start {
    std::span<const CVertexId> site;   ///< per cell, on `coarser.complex`, or on the surface if there is no coarser complex
    std::span<const float> radius;     ///< per c-vertex there, of a disk about it
    const VertexPlacement& placement;  ///< on the surface
    bool is_whole = true;              ///< no component of a trilinear isosurface is left out: then distances can be proved
  };

  /// @param surface   divided where a bound or the shape of triangles asks for more c-vertices than there are
  /// @param embedded        divide cells, and then the surface, where triangles meet others where they should not as these positions have
  ///                        it; none: they may
  /// @param most_divisions  per level, how often to divide the surface where cells at their limit are over a bound
  Refiner(AdaptiveSurface& surface, const Isosurface& isosurface, const Coarsened& coarser, const CoveringOptions& options, Start start,
          std::optional<WrittenPositions> embedded, std::uint32_t most_divisions);

  /// What can be said of level 0. To be called once, before refine().
  LevelFigures describe_coarse(std::span<const Triangle> triangles, const LevelGoal& goal, const RunControl& control);

  /// Makes the next level. Topology first, then the constraints in their order.
  RefinedLevel refine(const LevelGoal& goal, Placement placement, const RunControl& control);

  /// Makes the cells at the corners of these triangles smaller and meets the goal again.
  /// @param level  in: the result of refine(); out: the new level
  /// @pre   the level did not run out of vertices
  /// @return false if none of these cells can be smaller; then nothing has changed
  bool refine_at(std::span<const Triangle> triangles, const LevelGoal& goal, Placement placement, RefinedLevel& level,
                 const RunControl& control);

  /// Everything that refine() changes, the surface included. Restore it to try another level.
  struct State;
  std::shared_ptr<const State> save_state() const;
  void restore_state(const State& state);

  const Partition& partition() const { return work_->partition(); }
  const Surfels& surfels() const { return surface_data_->surfels; }
  const VertexPlacement& placement() const { return work_->placement(); }
  /// Per vertex, the vertex of the level before in whose cell it was placed. @pre refine() was called
  std::vector<std::uint32_t> parents() const;
  std::vector<ShapeObstacle> obstacles() const {
    return isoatlas::detail::obstacles(placement(), surface_, sites_before_);
  }  ///< per vertex, what keeps it where it is; of the last level

 private:
  using Task = RefinementTask;
  class Dual;
  Task whole_task(const LevelGoal& goal, Placement placement, RefinedLevel& out, const RunControl& control);
  RefinedLevel unchanged_level(const LevelGoal& asked) const;
  RefinedLevel refine_once(const LevelGoal& goal, const LevelGoal& asked, Placement placement, const RunControl& control);
  void restart_at_vertices(const RunControl& control);
  void make_predicted_cells(const Task& task, RefinedLevel& out, const RunControl& control);
  bool refine_within_budget(Task& task, double most, IntersectionTracker& meeting, RefinedLevel& out, const RunControl& control);
  void remove_sites(std::uint32_t count, const RunControl& control);
  void finish(const Task& task, const LevelGoal& asked, IntersectionTracker& meeting, RefinedLevel& out, const RunControl& control);
  void improve_level_shape(const Task& task, std::vector<DualTriangle>& triangles, RefinedLevel& out, const RunControl& control);
  void refine_and_improve(const Task& task, IntersectionTracker& meeting, std::vector<DualTriangle>& triangles, RefinedLevel& out,
                          const RunControl& control);
  void retry_bad_triangles(const Task& task, IntersectionTracker& meeting, std::vector<DualTriangle>& triangles, RefinedLevel& out,
                           const RunControl& control);
  void repair_worst_cells(const Task& task, std::vector<DualTriangle>& triangles, RefinedLevel& out, const RunControl& control);
  void revert_intersecting_changes(const Task& task, IntersectionTracker& meeting, std::vector<DualTriangle>& triangles, RefinedLevel& out,
                                   const RunControl& control);
  void describe(const Task& task, const LevelGoal& asked, RefinedLevel& out);
  bool refine_cells(std::span<const CellId> cells, const RunControl& control);
  bool can_refine(std::span<const CellId> cells) const;
  bool subdivide(std::span<const CellId> single, const RunControl& control);
  std::vector<CVertexId> sites_of(std::span<const CellId> cells) const;
  bool separate_intersections(IntersectionTracker& meeting, RefinedLevel& out, const RunControl& control);
  void work_apart(const Task& task, IntersectionTracker& meeting, RefinedLevel& out, const RunControl& control);
  void work_towards(const Task& task, IntersectionTracker& meeting, RefinedLevel& out, const RunControl& control);
  bool is_provable(const Task& task) const;
  void prove(const Task& task, const std::function<void()>& work_on);
  std::vector<CVertexId> places_at(std::span<const std::pair<double, CellId>> cells) const;
  std::vector<std::pair<double, CellId>> cells_at_limit(const Task& task);
  bool is_at_limit(const Task& task, CellId c) const;
  std::vector<std::pair<CellId, double>> cells_over(const LevelGoal& asked, std::span<const MetricValues> values) const;
  void step_down(const LevelGoal& goal, Placement placement, RefinedLevel& out, const RunControl& control);
  void remember_placed_in();
  void divide_surface(std::span<const CVertexId> wanted, const RunControl& control);

  CoveringOptions options_;
  AdaptiveSurface& surface_;
  const Isosurface& isosurface_;
  const Coarsened& coarser_;
  Start start_;
  std::optional<WrittenPositions> embedded_;
  std::uint32_t most_divisions_;
  std::unique_ptr<SurfaceData> surface_data_;  // of the surface as it is
  std::unique_ptr<MeasuredCovering> work_;
  RefinementRounds rounds_;
  std::vector<CellId> inserted_in_;  // per site, as far as it was placed on another complex than work_ stands on; else kNone
  std::uint32_t sites_before_;       // of the level before
  bool is_first_ = true;             // the level before is the coarse one
  std::uint32_t divisions_ = 0;      // of this level, for the sake of bounds
  int proofs_ = 0;                   // of this level, that failed
  MeshExtent extent_;                // of the last level, its metrics below
  std::array<MetricSummary, kMetricCount> metrics_{};
};

}  // namespace isoatlas::detail
