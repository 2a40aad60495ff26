// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "isoatlas/refine.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// How stage one covers the surface by disks; certificate and repair have the last word either way
/// (docs/theory/04-covering.md).
enum class CoveringStrategy : std::uint8_t {
  sizing_field,  ///< a radius per c-vertex that grows by a third of the distance at most, sites
                 ///< farthest first
  halving,  ///< the paper's own: bins of radii R_g / 2^i, every radius halved until it fits its
            ///< neighbours'
};

constexpr std::uint32_t kMaxSubdivisions =
    8;  ///< more often the surface is not divided for a bound

/// How stage one chooses the sizes of triangles.
struct CoveringChoice {
  CoveringStrategy strategy = CoveringStrategy::sizing_field;
  /// Largest disk radius R_g of the paper's stage one; none: half the longest side of the volume.
  std::optional<Length> max_radius{};
  /// Topological events that close again within this length do not limit a disk; none: 1.5 voxels,
  /// with halving 0.
  std::optional<Length> event_persistence{};
};

/// Components that are not meshed; nothing is left out unless asked for. The size of a component is
/// the volume it encloses, with the volume's border as a cap where that cuts it open. Components
/// that the cap connects count as one, a part.
struct ComponentChoice {
  double min_size = 0;  ///< drop smaller ones, world units cubed
  std::size_t keep_largest =
      0;  ///< keep only so many largest parts (ties: first in scan order); 0 keeps all
};

struct ExtractOptions {
  SurfaceOptions surface{};
  /// The reference surface is that of the volume upsampled so many times along each axis by the
  /// interpolation. Voxels are those of the volume, and positions in its sample-index coordinates.
  std::uint32_t supersample = 1;
  /// How often the surface may be divided, in each refined level, where cells as small as they can
  /// be are over a bound; 0: never.
  std::uint32_t adaptive_supersample = 6;
  /// false puts c-vertices at the plain average of their nodes, as the paper has it (up to 0.2
  /// voxel off the surface).
  bool vertices_on_surface = true;
  ComponentChoice components{};
  CoveringChoice covering{};
  /// Level 0 is the coarse mesh of the paper's stage one; its constraints are only looked at, not
  /// worked for.
  LevelGoal coarse{};
  /// One more level, refined from the one before, per entry. Empty: the coarse mesh alone.
  std::vector<LevelGoal> refine{default_goal()};
  Placement placement = Placement::surface;
  /// false: no level has self-intersections in the output space, nor after rounding to float32 if
  /// that moves positions by less than a thousandth of a voxel
  /// (docs/theory/06-self-intersections.md). Intersecting triangles are separated by smaller cells
  /// and finally by subdividing the surface complex. LevelReport::self_intersections counts what
  /// could not be separated.
  bool allow_self_intersections = false;
  Space space = Space::lps;  ///< of the mesh
  /// Measure every level against the isosurface with that many samples in each direction; 0: do
  /// not.
  std::size_t measure_samples = 0;
};

}  // namespace isoatlas
