// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "isoatlas/extract.h"
#include "partition/coarsen.h"
#include "refine/judge.h"
#include "refine/measured_covering.h"
#include "refine/shape.h"

namespace isoatlas {

struct LevelFigures {
  std::array<MetricSummary, kMetricCount> metrics{};
  std::vector<ConstraintResult> constraints;  ///< in the order given
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

/// Stage two: makes a covering finer where metrics ask for it, level by level (paper, 3.4 and figure 8). Lengths are in voxels.
///
/// While cells are large it works on the coarser complex, then steps down to the surface itself; sites keep their vertices. In
/// every round the worst cells get a new site where they are farthest from the mesh, or a smaller radius; what changed is covered,
/// certified and measured again.
class Refiner {
 public:
  /// @param coarse  the covering of level 0, of `coarser.complex`, or of the surface if there is no coarser complex
  /// @param embedded  divide cells whose triangles meet others where they should not
  Refiner(const SurfaceComplex& surface, const Isosurface& isosurface, const Coarsened& coarser, const CoveringOptions& options,
          const Covering& coarse, const std::vector<Vec3>& coarse_shift, bool embedded);

  /// What can be said of level 0. To be called once, before refine().
  /// @param sites  per vertex of the level, its c-vertex on the surface
  LevelFigures describe_coarse(std::span<const Triangle> triangles, std::span<const CVertexId> sites, const LevelGoal& goal,
                               const RunControl& control);

  /// Makes the next level. Topology first, then the constraints in their order.
  RefinedLevel refine(const LevelGoal& goal, Placement placement, const RunControl& control);

  const Partition& partition() const { return work_->partition(); }
  const Surfels& surfels() const { return ground_.surfels; }
  const Places& places() const { return work_->places(); }
  /// Per vertex, the vertex of the level before in whose cell it was placed. @pre refine() was called
  std::vector<std::uint32_t> parents() const;

 private:
  struct Task;
  void work(MeasuredCovering& work, const Task& task, RefinedLevel& out, const RunControl& control);
  void meet(MeasuredCovering& work, const Task& task, RefinedLevel& out, const RunControl& control);
  std::vector<CVertexId> work_on_shape(MeasuredCovering& work, const Task& task, std::size_t room, std::span<const CVertexId> given_up);
  bool work_around(MeasuredCovering& work, const Task& task, const std::vector<DualTriangle>& triangles);
  Task whole_task(const LevelGoal& goal, Placement placement, RefinedLevel& out, const RunControl& control);
  bool is_at_limit(CellId c) const;
  std::vector<std::pair<CellId, double>> cells_over(const Task& task, std::span<const MetricValues> values) const;
  void step_down(const LevelGoal& goal, Placement placement, RefinedLevel& out, const RunControl& control);

  CoveringOptions options_;
  const Coarsened& coarser_;
  const Covering& coarse_;
  const std::vector<Vec3>& coarse_shift_;
  bool embedded_;
  Ground ground_;
  std::unique_ptr<MeasuredCovering> work_;
  std::vector<CellId> placed_in_;  // per site of the first part of refinement, on the coarser complex
  std::uint32_t sites_before_;     // of the level before
  MeshExtent extent_;              // of the last level, its metrics below
  std::array<MetricSummary, kMetricCount> metrics_{};
};

}  // namespace isoatlas
