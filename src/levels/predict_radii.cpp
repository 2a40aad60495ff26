// SPDX-License-Identifier: Apache-2.0
// Ours. Uses the classic result that the distance of a mesh from a smooth surface is proportional
// to the square of its triangles' size.
#include "levels/predict_radii.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/epoch_set.h"
#include "core/parallel.h"
#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kGrain = 2048,
                      kCancelInterval = 32;  // c-vertices per chunk; between tests for cancellation
// Radius of the neighbourhood in distances to the farthest neighbour in G: large enough that noise
// of less than a voxel does not look like curvature.
constexpr double kNeighbourhoodRadius = 2.5;
constexpr std::size_t kMinNeighbours = 6;  // smallest neighbourhood that determines a curvature
// The predicted radius relative to the one at which the height equals the bound; and its largest
// ratio to the radius of the neighbourhood.
constexpr double kRadiusFactor = 1.65, kMaxFactor = 3 * kRadiusFactor;

// The height of a c-vertex's connected neighbourhood within `reach`, over its best-fitting plane.
class Neighbourhood {
 public:
  explicit Neighbourhood(const SurfaceData& surface_data) : surface_data_(surface_data) {}

  /// @return negative if there are too few c-vertices
  double height(CVertexId v, double reach) {
    const Surfels& surfels = surface_data_.surfels;
    seen_.clear();
    seen_.insert(v);
    neighbours_.assign(1, v);
    Vec3 normal{}, sum{};
    for (std::size_t i = 0; i < neighbours_.size(); ++i) {
      const CVertexId u = neighbours_[i];
      normal = normal + surfels.normal[u];
      sum = sum + (surfels.point[u] - surfels.point[v]);
      for (const CVertexGraph::Neighbour& n : surface_data_.graph.row(u)) {
        if (seen_.insert(n.id) &&
            squared_length(surfels.point[n.id] - surfels.point[v]) <= reach * reach)
          neighbours_.push_back(n.id);
      }
    }
    if (neighbours_.size() < kMinNeighbours || normal == Vec3{}) return -1;
    normal = normalized(normal);
    const Vec3 centre = surfels.point[v] + (1 / static_cast<double>(neighbours_.size())) * sum;
    double low = 0, high = 0;
    for (const CVertexId u : neighbours_) {
      const double h = dot(normal, surfels.point[u] - centre);
      low = std::min(low, h);
      high = std::max(high, h);
    }
    return high - low;
  }

 private:
  const SurfaceData& surface_data_;
  EpochSet seen_;
  std::vector<CVertexId> neighbours_;
};

}  // namespace

std::vector<Covering::Radius> predict_radii(const SurfaceData& surface_data,
                                            std::span<const CVertexId> at, double bound) {
  std::vector<Covering::Radius> out(at.size());
  for_each_chunk(at.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    Neighbourhood neighbourhood(surface_data);
    for (std::size_t i = begin; i < end; ++i) {
      if (i % kCancelInterval == 0) surface_data.check_cancelled();
      const double reach =
          kNeighbourhoodRadius * static_cast<double>(surface_data.farthest_neighbour[at[i]]);
      const double height = neighbourhood.height(at[i], reach);
      const double factor =
          height < 0 ? INFINITY : std::min(kMaxFactor, kRadiusFactor * std::sqrt(bound / height));
      out[i] = {at[i], static_cast<float>(reach * factor)};
    }
  });
  std::erase_if(out, [](const Covering::Radius& r) { return !std::isfinite(r.radius); });
  return out;
}

}  // namespace isoatlas::detail
