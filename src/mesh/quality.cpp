// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/vector_math.h"
#include "isoatlas/mesh.h"

namespace isoatlas {

MeshQuality mesh_quality(const TriangleMesh& mesh) {
  MeshQuality q;
  q.triangles = mesh.triangles.size();
  if (mesh.triangles.empty()) return q;
  std::vector<double> aspect;
  aspect.reserve(mesh.triangles.size());
  q.angle_min = 180;
  q.edge_min = std::numeric_limits<double>::infinity();
  std::size_t below = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 p[3] = {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    const double edge[3] = {length(p[1] - p[0]), length(p[2] - p[1]), length(p[0] - p[2])};
    const auto [shortest, longest] = std::minmax({edge[0], edge[1], edge[2]});
    q.edge_min = std::min(q.edge_min, shortest);
    q.edge_max = std::max(q.edge_max, longest);
    const double ratio = longest > 0 && std::isfinite(longest) ? shortest / longest : 0;
    aspect.push_back(ratio);
    // Compared in the same arithmetic as the ratio itself, so that an exact 1/3 is not below.
    if (3 * shortest < longest || longest == 0) ++below;
    ++q.aspect_histogram[std::min<std::size_t>(19, static_cast<std::size_t>(ratio * 20))];
    for (int k = 0; k < 3; ++k) {
      const Vec3 u = p[(k + 1) % 3] - p[k], v = p[(k + 2) % 3] - p[k];
      const double angle = std::atan2(length(cross(u, v)), dot(u, v)) * 180 / std::numbers::pi;
      q.angle_min = std::min(q.angle_min, angle);
      q.angle_max = std::max(q.angle_max, angle);
    }
    if (length(cross(p[1] - p[0], p[2] - p[0])) == 0) ++q.zero_area_triangles;
  }
  const auto quantile = [&](double share) {
    const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(aspect.size() - 1));
    std::nth_element(aspect.begin(), aspect.begin() + k, aspect.end());
    return aspect[static_cast<std::size_t>(k)];
  };
  q.aspect_min = quantile(0);
  q.aspect_p01 = quantile(0.01);
  q.aspect_median = quantile(0.5);
  q.aspect_share_below_third = static_cast<double>(below) / static_cast<double>(mesh.triangles.size());
  return q;
}

}  // namespace isoatlas
