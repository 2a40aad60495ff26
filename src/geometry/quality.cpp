// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <new>
#include <numbers>
#include <tuple>
#include <vector>

#include "core/cancel_poll.h"
#include "core/ranges.h"
#include "core/vector_math.h"
#include "geometry/require_corners.h"
#include "isoatlas/error.h"
#include "isoatlas/mesh.h"

namespace isoatlas {
using namespace detail;
namespace {

// A triangle with a larger angle is a cap: its corners are nearly on a line, although its edges may
// have similar lengths.
constexpr double kCapAngle = 150;

// The dihedral angle at an edge from p to q; `left` and `right` are the third corners of the
// triangles that run from p to q and from q to p.
double interior_dihedral_angle(Vec3 p, Vec3 q, Vec3 left, Vec3 right) {
  const Vec3 first = cross(q - p, left - p), second = cross(p - q, right - q);
  const double between =
      std::atan2(length(cross(first, second)), dot(first, second)) * 180 / std::numbers::pi;
  return dot(first, right - p) > 0 ? 180 + between : 180 - between;
}

void measure_dihedral_angles(const MeshView& mesh, MeshQuality& quality,
                             const RunControl& control) {
  struct Side {
    std::uint32_t low, high, opposite;
    bool ascends;  // the triangle runs from low to high
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k], to = t[(k + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), t[(k + 2) % 3], from < to});
    }
  }
  control.check_cancelled();
  ranges::sort(sides, [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.opposite, a.ascends) <
           std::tie(b.low, b.high, b.opposite, b.ascends);
  });
  CancelPoll poll(control);
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    poll.step();
    const Side &a = sides[i], &b = sides[i + 1];
    if (a.low != b.low || a.high != b.high || a.ascends == b.ascends) continue;
    const Side &up = a.ascends ? a : b, &down = a.ascends ? b : a;
    const Vec3 p = mesh.positions[a.low], q = mesh.positions[a.high];
    const double angle =
        interior_dihedral_angle(p, q, mesh.positions[up.opposite], mesh.positions[down.opposite]);
    quality.dihedral_min = std::min(quality.dihedral_min, angle);
    quality.dihedral_max = std::max(quality.dihedral_max, angle);
  }
}

}  // namespace

MeshQuality mesh_quality(const MeshView& mesh, const RunControl& control) try {
  require_corners(mesh);
  MeshQuality q;
  q.triangles = mesh.triangles.size();
  if (mesh.triangles.empty()) return q;
  std::vector<double> aspect;
  aspect.reserve(mesh.triangles.size());
  q.angle_min = 180;
  q.edge_min = std::numeric_limits<double>::infinity();
  std::size_t below = 0;
  CancelPoll poll(control);
  for (const Triangle& t : mesh.triangles) {
    poll.step();
    const Vec3 p[3] = {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    const double edge[3] = {length(p[1] - p[0]), length(p[2] - p[1]), length(p[0] - p[2])};
    const auto [shortest, longest] = std::minmax({edge[0], edge[1], edge[2]});
    q.edge_min = std::min(q.edge_min, shortest);
    q.edge_max = std::max(q.edge_max, longest);
    const double ratio = longest > 0 && std::isfinite(longest) ? shortest / longest : 0;
    aspect.push_back(ratio);
    // Uses the same arithmetic as the ratio itself, so that an exact 1/3 is not below.
    if (3 * shortest < longest || longest == 0) ++below;
    ++q.aspect_histogram[std::min<std::size_t>(19, static_cast<std::size_t>(ratio * 20))];
    double largest = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec3 u = p[(k + 1) % 3] - p[k], v = p[(k + 2) % 3] - p[k];
      const double angle = std::atan2(length(cross(u, v)), dot(u, v)) * 180 / std::numbers::pi;
      q.angle_min = std::min(q.angle_min, angle);
      largest = std::max(largest, angle);
    }
    q.angle_max = std::max(q.angle_max, largest);
    if (largest > kCapAngle) ++q.angles_above_150;
    if (length(cross(p[1] - p[0], p[2] - p[0])) == 0) ++q.zero_area_triangles;
  }
  measure_dihedral_angles(mesh, q, control);
  const auto quantile = [&](double share) {
    const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(aspect.size() - 1));
    std::nth_element(aspect.begin(), aspect.begin() + k, aspect.end());
    return aspect[static_cast<std::size_t>(k)];
  };
  q.aspect_min = quantile(0);
  q.aspect_p01 = quantile(0.01);
  q.aspect_median = quantile(0.5);
  q.aspect_share_below_third =
      static_cast<double>(below) / static_cast<double>(mesh.triangles.size());
  return q;
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory for the shape of this mesh");
}

}  // namespace isoatlas
