// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "isoatlas/refine.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// How the coarse level covers the surface by disks (docs/theory/04-covering.md). The certificate
/// and the repair that follow are the same for both.
enum class CoveringStrategy : std::uint8_t {
  /// A 1/3-Lipschitz sizing field: radii grow by at most a third of the distance along the surface.
  /// Sites are chosen farthest first.
  sizing_field,
  /// The paper's algorithm: radii R_g / 2^i, each halved until it fits those of its neighbours.
  halving,
};

/// Upper limit of ExtractOptions::adaptive_supersample.
constexpr std::uint32_t kMaxSubdivisions = 8;
/// Upper limit of ExtractOptions::levels.
constexpr std::uint32_t kMaxLevels = 16;

/// How the covering by disks determines the sizes of the triangles of the coarse level.
struct CoveringChoice {
  CoveringStrategy strategy = CoveringStrategy::sizing_field;
  /// Largest radius of a disk (R_g in the paper). Default: half the longest side of the volume.
  std::optional<Length> max_radius{};
  /// A topological event whose front closes within this length does not limit a disk. Default: 1.5
  /// voxels; 0 with CoveringStrategy::halving.
  std::optional<Length> event_persistence{};
};

/// Which components of the isosurface are meshed; by default all. The size of a component is the
/// volume it encloses. A component that the volume boundary cuts open is closed by a cap on that
/// boundary. Components that the cap connects form one part and have its size.
struct ComponentChoice {
  double min_size = 0;  ///< drop components of a smaller size, world units cubed
  /// Keep only this number of largest parts (ties: first in scan order); 0 keeps all.
  std::size_t keep_largest = 0;
  /// Keep only the parts of the components nearest to these points, in the coordinates of the mesh
  /// (ExtractOptions::space); empty keeps all.
  std::vector<Vec3> keep_near{};
  std::vector<Vec3> drop_near{};  ///< drop the parts of the components nearest to these points

  /// True if any component can be dropped.
  bool selects() const {
    return min_size > 0 || keep_largest > 0 || !keep_near.empty() || !drop_near.empty();
  }
};

/// What a mesh does where the volume boundary cuts the surface.
enum class Border : std::uint8_t {
  open,    ///< it ends there, in boundary loops on the volume boundary
  closed,  ///< it is closed by planar caps on the volume boundary, as if all beyond it were outside
};

/// Options of extract().
struct ExtractOptions {
  SurfaceOptions surface{};
  /// Mesh the volume upsampled by this factor along each axis, with `surface.interpolation`; at
  /// least 1. Lengths in voxels, and sample-index coordinates, still refer to the original volume.
  std::uint32_t supersample = 1;
  /// In each refined level, subdivide the surface complex up to this number of times where Voronoi
  /// cells violate a bound and cannot become smaller. 0: never. At most kMaxSubdivisions.
  std::uint32_t adaptive_supersample = 6;
  /// true: c-vertices lie on the isosurface. false: they are the averages of their nodes, as in the
  /// paper, up to 0.2 voxels off the surface.
  bool vertices_on_surface = true;
  ComponentChoice components{};
  Border border = Border::open;
  CoveringChoice covering{};
  /// Constraints of level 0, the coarse mesh of the paper's stage one. They are only evaluated and
  /// reported; level 0 is not refined.
  LevelGoal coarse{};
  /// One refined level per entry, each refined from the previous level. Empty: only level 0.
  std::vector<LevelGoal> refine{default_goal()};
  /// If above 0, extract() plans this number of levels: `refine` has one goal, that of the finest
  /// level, with a bound on the distance. Each coarser level has twice the bound of the next, or
  /// less, by the same factor for all, so that the coarsest keeps a recognisable shape. The other
  /// constraints hold in every level. The coarse mesh of stage one is then not part of the result.
  /// At most kMaxLevels. ladder() makes such goals from a given coarsest bound.
  std::uint32_t levels = 0;
  Placement placement = Placement::surface;
  /// false: self-intersections are separated in every level, by smaller Voronoi cells and finally
  /// by subdividing the surface complex. Tests use the output coordinates, and also those rounded
  /// to float32 if that moves positions by less than a thousandth of a voxel
  /// (docs/theory/06-self-intersections.md). LevelReport::self_intersections counts pairs that
  /// could not be separated.
  bool allow_self_intersections = false;
  Space space = Space::lps;  ///< coordinates of the mesh
  /// Measure the distance of every level with this number of samples in each direction, see
  /// measure(). 0: do not measure.
  std::size_t measure_samples = 0;
};

}  // namespace isoatlas
