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
#include "levels/constraint_results.h"
#include "levels/refined_level.h"
#include "levels/rounds.h"
#include "optimize/shape_optimizer.h"

namespace isoatlas::detail {

/// Stage two: refines a covering where metrics require it, level by level (paper, 3.4 and figure
/// 8). Lengths are in voxels.
///
/// While cells are large it uses the coarser complex, then moves to the surface itself; sites
/// keep their vertices. In every round the worst cells get a new site where they are farthest from
/// the mesh, or a smaller radius; what has changed is covered, certified and measured again.
class Refiner {
 public:
  /// Level 0.
  struct Start {
    std::span<const CVertexId>
        site;  ///< per cell, on `coarser.complex`, or on the surface if there is no coarser complex
    std::span<const float> radius;  ///< per c-vertex of that complex, the radius of a disk about it
    const VertexPlacement& placement;  ///< on the surface
    bool is_complete = true;  ///< the surface has all components of a trilinear isosurface;
                              ///< otherwise distances cannot be proved
  };

  /// @param surface  is subdivided where a bound or the shape of triangles requires more c-vertices
  /// @param output_positions   the positions for which self-intersections must be resolved; none:
  ///                           self-intersections are allowed
  /// @param max_subdivisions  per level, how often the surface may be subdivided because cells at
  ///                          the resolution limit violate a bound
  Refiner(AdaptiveSurface& surface, const Isosurface& isosurface, const Coarsened& coarser,
          const CoveringOptions& options, Start start,
          std::optional<OutputPositions> output_positions, std::uint32_t max_subdivisions);

  /// The figures of level 0. Must be called once, before refine().
  LevelFigures describe_coarse(std::span<const Triangle> triangles, const LevelGoal& goal,
                               const RunControl& control);

  /// Makes the next level: topology first, then the constraints in their order.
  RefinedLevel refine(const LevelGoal& goal, Placement placement, const RunControl& control);

  /// Makes the cells at the corners of these triangles smaller and refines to the goal again.
  /// @param level  in: the result of refine(); out: the new level
  /// @pre   the level did not run out of vertices
  /// @return false if none of these cells can become smaller; then nothing has changed
  bool refine_at(std::span<const Triangle> triangles, const LevelGoal& goal, Placement placement,
                 RefinedLevel& level, const RunControl& control);

  /// Everything that refine() changes, including the surface. Restore it to try another level.
  struct State;
  std::shared_ptr<const State> save_state() const;
  void restore_state(const State& state);

  const Partition& partition() const { return measured_->partition(); }
  const Surfels& surfels() const { return surface_data_->surfels; }
  const VertexPlacement& placement() const { return measured_->placement(); }
  /// Per vertex, the vertex of the previous level in whose cell it was inserted. @pre refine() was
  /// called
  std::vector<std::uint32_t> parents() const;
  std::vector<ShapeObstacle> obstacles() const {
    return isoatlas::detail::obstacles(placement(), surface_, previous_site_count_);
  }  ///< per vertex of the last level, why it cannot be moved

 private:
  using Task = RefinementTask;
  class Dual;
  Task prepare_task(const LevelGoal& goal, Placement placement, RefinedLevel& out,
                    const RunControl& control);
  RefinedLevel unchanged_level(const LevelGoal& requested) const;
  RefinedLevel refine_once(const LevelGoal& goal, const LevelGoal& requested, Placement placement,
                           const RunControl& control);
  void restart_with_sites_at_vertices(const RunControl& control);
  void lower_predicted_radii(const Task& task, RefinedLevel& out, const RunControl& control);
  bool refine_within_budget(Task& task, double most, IntersectionTracker& tracker,
                            RefinedLevel& out, const RunControl& control);
  void remove_sites(std::uint32_t count, const RunControl& control);
  void finish(const Task& task, const LevelGoal& requested, IntersectionTracker& tracker,
              RefinedLevel& out, const RunControl& control);
  void improve_level_shape(const Task& task, std::vector<DualTriangle>& triangles,
                           RefinedLevel& out, const RunControl& control);
  void refine_and_improve(const Task& task, IntersectionTracker& tracker,
                          std::vector<DualTriangle>& triangles, RefinedLevel& out,
                          const RunControl& control);
  void retry_bad_triangles(const Task& task, IntersectionTracker& tracker,
                           std::vector<DualTriangle>& triangles, RefinedLevel& out,
                           const RunControl& control);
  void repair_worst_cells(const Task& task, std::vector<DualTriangle>& triangles, RefinedLevel& out,
                          const RunControl& control);
  void revert_intersecting_changes(const Task& task, IntersectionTracker& tracker,
                                   std::vector<DualTriangle>& triangles, RefinedLevel& out,
                                   const RunControl& control);
  void revert_until_embedded(IntersectionTracker& tracker, std::vector<DualTriangle>& triangles,
                             RefinedLevel& out, const RunControl& control);
  void prove_changes(const Task& task, IntersectionTracker& tracker,
                     std::vector<DualTriangle>& triangles, RefinedLevel& out,
                     const RunControl& control);
  LevelMesh coarse_mesh(const Covering& covering, const RunControl* control) const;
  CustomMaximum custom_maxima() const;
  void describe(const Task& task, const LevelGoal& requested, RefinedLevel& out);
  bool refine_cells(std::span<const CellId> cells, const RunControl& control);
  bool can_refine(std::span<const CellId> cells) const;
  bool subdivide(std::span<const CellId> single, const RunControl& control);
  std::vector<CVertexId> sites_of(std::span<const CellId> cells) const;
  bool separate_intersections(IntersectionTracker& tracker, RefinedLevel& out,
                              const RunControl& control);
  void refine_and_separate(const Task& task, IntersectionTracker& tracker, RefinedLevel& out,
                           const RunControl& control);
  void refine_with_subdivision(const Task& task, IntersectionTracker& tracker, RefinedLevel& out,
                               const RunControl& control);
  bool is_provable(const Task& task) const;
  void prove(const Task& task, const std::function<void()>& refine_again);
  std::vector<CVertexId> c_vertices_near(std::span<const std::pair<double, CellId>> cells) const;
  std::vector<std::pair<double, CellId>> cells_at_limit(const Task& task);
  bool is_at_limit(const Task& task, CellId c) const;
  std::vector<std::pair<CellId, double>> violating_cells(
      const LevelGoal& requested, std::span<const MetricValues> values) const;
  void refine_coarser_complex(const LevelGoal& goal, Placement placement, RefinedLevel& out,
                              const RunControl& control);
  void save_inserted_in();
  void subdivide_surface(std::span<const CVertexId> wanted, const RunControl& control);

  CoveringOptions options_;
  AdaptiveSurface& surface_;
  const Coarsened& coarser_;
  Start start_;
  std::optional<OutputPositions> output_positions_;
  std::uint32_t max_subdivisions_;
  std::unique_ptr<SurfaceData> surface_data_;  // of the current surface
  std::unique_ptr<MeasuredCovering> measured_;
  RefinementRounds rounds_;
  std::vector<CellId> inserted_in_;  // per site inserted on an earlier complex: the Voronoi cell it
                                     // was inserted in; kNone otherwise
  std::uint32_t previous_site_count_;  // number of vertices of the previous level
  bool is_first_refined_ = true;       // the previous level is the coarse one
  std::uint32_t subdivisions_ = 0;     // of this level, because of bounds
  int proofs_ = 0;                     // number of failed proofs for this level
  bool was_proved_ = false;            // whether the last proof of this level succeeded
  MeshStatistics statistics_;          // of the last level, as are the metrics below
  std::vector<Triangle> coarse_triangles_;
  std::array<MetricSummary, kMetricCount> metrics_{};
};

}  // namespace isoatlas::detail
