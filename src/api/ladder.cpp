// SPDX-License-Identifier: Apache-2.0
// The levels that extract() plans by itself.
#include "api/ladder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/require.h"
#include "core/vector_math.h"
#include "isoatlas/error.h"

namespace isoatlas {
namespace {

const Constraint* distance_bound(const LevelGoal& goal) {
  for (const Constraint& c : goal)
    if (c.quantity == Quantity::max_distance) return &c;
  return nullptr;
}

}  // namespace

std::vector<LevelGoal> ladder(std::size_t levels, const LevelGoal& finest, Length coarsest) {
  using detail::require;
  const Constraint* bound = distance_bound(finest);
  require(levels >= 1, "a ladder has at least one level");
  require(bound != nullptr, "a ladder needs a bound on max-distance for its finest level");
  require(bound->in_voxels == coarsest.in_voxels,
          "the finest and the coarsest bound of a ladder must both be in voxels or in world units");
  require(std::isfinite(bound->bound) && bound->bound > 0 && std::isfinite(coarsest.value) &&
              coarsest.value >= bound->bound,
          "the coarsest bound of a ladder must be a length, at least that of the finest level");
  std::vector<LevelGoal> goals(levels, finest);
  if (levels == 1) return goals;
  const double ratio = std::pow(coarsest.value / bound->bound, 1 / static_cast<double>(levels - 1));
  double factor = 1;  // products of a whole ratio are exact
  for (std::size_t k = levels - 1; k-- > 0;) {
    factor *= ratio;
    for (Constraint& c : goals[k])
      if (c.quantity == Quantity::max_distance)
        c.bound = k == 0 ? coarsest.value : factor * c.bound;
  }
  return goals;
}

namespace detail {
namespace {

// Between two levels the bound is halved, unless the coarsest one would exceed
// recognisable_distance(). For a smooth surface half the bound takes about twice the triangles.
constexpr double kLevelRatio = 2;
// Share of the diagonal of a component's bounding box.
constexpr double kRecognisableShare = 1.0 / 30;

}  // namespace

double recognisable_distance(const SurfaceComplex& surface, const Components& components) {
  struct Size {
    double area = 0;
    Vec3 low, high;
    bool is_empty = true;
  };
  std::vector<Size> sizes(components.topology.size());
  for (const Face& face : surface.faces) {
    Size& size = sizes[components.of_c_vertex[face.corner[0]]];
    const auto at = [&](int k) {
      return to_metric(surface.positions[face.corner[k]], surface.spacing);
    };
    size.area += length(cross(at(2) - at(0), at(face.size() - 1) - at(1))) / 2;
    for (int k = 0; k < face.size(); ++k) {
      const Vec3 p = at(k);
      if (std::exchange(size.is_empty, false)) size.low = size.high = p;
      size.low = {std::min(size.low.x, p.x), std::min(size.low.y, p.y), std::min(size.low.z, p.z)};
      size.high = {std::max(size.high.x, p.x), std::max(size.high.y, p.y),
                   std::max(size.high.z, p.z)};
    }
  }
  double area = 0, sum = 0;
  for (const Size& size : sizes) {
    area += size.area;
    sum += size.area * length(size.high - size.low);
  }
  return area > 0 ? kRecognisableShare * sum / area : 0;
}

std::vector<LevelGoal> planned_levels(const ExtractOptions& options, const SurfaceComplex& surface,
                                      const Components& components, double voxel) {
  const LevelGoal& finest = options.refine.front();
  const double bound = distance_bound(finest)->bound;
  const double coarsest =
      std::min(bound * std::pow(kLevelRatio, static_cast<double>(options.levels) - 1),
               voxel * recognisable_distance(surface, components));
  return ladder(options.levels, finest, std::max(bound, coarsest));
}

}  // namespace detail
}  // namespace isoatlas
