// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isoatlas/hierarchy.h"
#include "isosurface/isosurface.h"
#include "levels/coarse_mesher.h"
#include "levels/refiner.h"

namespace isoatlas::detail {

/// The results of the coarse level that finer levels need. Lengths are in voxels (smallest
/// spacings).
struct LevelSource {
  const Grid& grid;  ///< of the original volume
  AdaptiveSurface& surface;
  const Isosurface& isosurface;
  const Coarsened& coarser;
  const CoveringOptions& options;
  const CoarseLevel& coarse;
  const OutputPositions& output_positions;
};

/// Describes the coarse level and adds the refined ones: each is checked, measured if requested,
/// and converted to the output space.
class LevelMaker {
 public:
  LevelMaker(const LevelSource& source, const ExtractOptions& options, const RunControl& control);

  /// Fills in metrics, constraints and distances of level 0. Must be called first.
  void describe_coarse(Hierarchy& hierarchy, LevelReport& report);

  void add_level(const LevelGoal& goal, Hierarchy& hierarchy, std::vector<LevelReport>& reports);

 private:
  Vec3 to_output_space(Vec3 index) const;
  void fill_report(const LevelGoal& goal, const LevelFigures& figures, LevelReport& report) const;
  std::vector<float> world_lengths(std::vector<float> voxels) const;
  void fill_measurement(Measurement measured, LevelReport& report) const;
  TriangleMesh mesh_of(const RefinedLevel& refined) const;
  Measurement refine_to_measured_bound(const LevelGoal& goal, RefinedLevel& refined,
                                       const RunControl& control);
  RunControl control_of_level(std::size_t refined_before) const;

  LevelSource source_;
  const ExtractOptions& options_;
  const RunControl& control_;
  Refiner refiner_;
};

}  // namespace isoatlas::detail
