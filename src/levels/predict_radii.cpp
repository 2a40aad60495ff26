// SPDX-License-Identifier: Apache-2.0
// Ours. That the distance of a mesh from a smooth surface goes with the square of its triangles' size is classic.
#include "levels/predict_radii.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/epoch_set.h"
#include "core/parallel.h"
#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kGrain = 2048, kLook = 32;  // c-vertices in a piece; between looks at whether to stop
// How far it is looked, in distances to the farthest neighbour in G: far enough for noise of less than a voxel not to look like curvature.
constexpr double kReach = 2.5;
constexpr std::size_t kFewest = 6;  // c-vertices that say something about curvature
// Of the radius at which the surroundings' height is the bound; and at most how many times as far as it was looked.
constexpr double kOptimism = 1.65, kFarthest = 3 * kOptimism;

// The height of what is around a c-vertex, within `reach` of it and connected, over the plane that it is most nearly in.
class Surroundings {
 public:
  explicit Surroundings(const SurfaceData& surface_data) : surface_data_(surface_data) {}

  /// @return negative if there are too few c-vertices
  double height(CVertexId v, double reach) {
    const Surfels& surfels = surface_data_.surfels;
    seen_.clear();
    seen_.insert(v);
    around_.assign(1, v);
    Vec3 normal{}, sum{};
    for (std::size_t i = 0; i < around_.size(); ++i) {
      const CVertexId u = around_[i];
      normal = normal + surfels.normal[u];
      sum = sum + (surfels.point[u] - surfels.point[v]);
      for (const CVertexGraph::Neighbour& n : surface_data_.graph.row(u)) {
        if (seen_.insert(n.id) && squared_length(surfels.point[n.id] - surfels.point[v]) <= reach * reach) around_.push_back(n.id);
      }
    }
    if (around_.size() < kFewest || normal == Vec3{}) return -1;
    normal = normalized(normal);
    const Vec3 centre = surfels.point[v] + (1 / static_cast<double>(around_.size())) * sum;
    double low = 0, high = 0;
    for (const CVertexId u : around_) {
      const double h = dot(normal, surfels.point[u] - centre);
      low = std::min(low, h);
      high = std::max(high, h);
    }
    return high - low;
  }

 private:
  const SurfaceData& surface_data_;
  EpochSet seen_;
  std::vector<CVertexId> around_;
};

}  // namespace

std::vector<Covering::Radius> predict_radii(const SurfaceData& surface_data, std::span<const CVertexId> at, double bound) {
  std::vector<Covering::Radius> out(at.size());
  for_each_piece(at.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    Surroundings surroundings(surface_data);
    for (std::size_t i = begin; i < end; ++i) {
      if (i % kLook == 0) surface_data.check_cancelled();
      const double reach = kReach * static_cast<double>(surface_data.farthest_neighbour[at[i]]);
      const double height = surroundings.height(at[i], reach);
      const double times = height < 0 ? INFINITY : std::min(kFarthest, kOptimism * std::sqrt(bound / height));
      out[i] = {at[i], static_cast<float>(reach * times)};
    }
  });
  std::erase_if(out, [](const Covering::Radius& r) { return !std::isfinite(r.radius); });
  return out;
}

}  // namespace isoatlas::detail
