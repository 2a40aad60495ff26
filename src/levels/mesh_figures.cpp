// SPDX-License-Identifier: Apache-2.0
#include "levels/mesh_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/vector_math.h"
#include "isoatlas/self_intersections.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kMaxListedIntersections = 10;  // number of self-intersections that are listed
constexpr double kMinAspect = 1.0 / 3;
constexpr double kMaxAngle = 150;  // degrees; a cap has no short edge, so its angle is tested

// 1 if the worse criterion is just satisfied, less if it is violated.
double shape_score(const BadTriangle& t, double least_aspect) {
  return std::min(t.aspect_ratio / least_aspect, (180 - t.largest_angle) / (180 - kMaxAngle));
}

}  // namespace

std::vector<BadTriangle> bad_triangles(const MeshView& world, const MeshView& output,
                                       std::span<const ShapeObstacle> obstacles,
                                       const LevelGoal& goal) {
  double min_aspect = kMinAspect;
  for (const Constraint& c : goal) {
    if (c.quantity == Quantity::min_aspect) min_aspect = c.bound;
  }
  const double cap_cosine = std::cos(kMaxAngle * std::numbers::pi / 180);
  std::vector<BadTriangle> out;
  for (const Triangle& t : world.triangles) {
    std::array<Vec3, 3> side;  // side k runs from corner k to the next one
    std::array<double, 3> edge;
    for (std::size_t k = 0; k < 3; ++k) {
      side[k] = world.positions[t[(k + 1) % 3]] - world.positions[t[k]];
      edge[k] = length(side[k]);
    }
    const auto [low, high] = std::minmax_element(edge.begin(), edge.end());
    const double aspect = *high > 0 ? *low / *high : 0;
    const auto across = static_cast<std::size_t>(
        high - edge.begin());  // the longest side, opposite to the largest angle
    const std::size_t obtuse = (across + 2) % 3;
    const Vec3 u = side[obtuse], v = -1.0 * side[(obtuse + 2) % 3];
    const bool is_cap = dot(u, v) < cap_cosine * edge[obtuse] * edge[(obtuse + 2) % 3];
    if (aspect >= min_aspect && !is_cap) continue;
    // If either endpoint of the shortest edge (or the obtuse corner of a cap) could move, no better
    // position exists; otherwise report the obstacle of the current level first.
    const auto k = static_cast<std::size_t>(low - edge.begin());
    const ShapeObstacle a = obstacles[aspect < min_aspect ? t[k] : t[obtuse]],
                        b = obstacles[aspect < min_aspect ? t[(k + 1) % 3] : t[obtuse]];
    const ShapeObstacle obstacle =
        a == ShapeObstacle::none || b == ShapeObstacle::none ? ShapeObstacle::none : std::max(a, b);
    const double angle = std::atan2(length(cross(u, v)), dot(u, v)) * 180 / std::numbers::pi;
    out.push_back(
        {(1.0 / 3) * (output.positions[t[0]] + output.positions[t[1]] + output.positions[t[2]]),
         aspect, angle, obstacle});
  }
  std::stable_sort(out.begin(), out.end(), [&](const BadTriangle& a, const BadTriangle& b) {
    return shape_score(a, min_aspect) < shape_score(b, min_aspect);
  });
  return out;
}

std::vector<ComponentExtent> extents_of(const TriangleMesh& world, const TriangleMesh& output,
                                        const MeshTopology& topology, const RunControl& control) {
  std::vector<ComponentExtent> extents = component_extents(world, topology, control);
  if (&world == &output) return extents;
  const std::vector<ComponentExtent> in_output = component_extents(output, topology, control);
  for (std::size_t c = 0; c < extents.size(); ++c) extents[c].bounds = in_output[c].bounds;
  return extents;
}

void fill_self_intersections(const TriangleMesh& mesh, LevelReport& report,
                             const RunControl& control) {
  const std::vector<TrianglePair> pairs =
      self_intersections(mesh.positions, mesh.triangles, {}, control);
  report.self_intersections = pairs.size();
  for (const auto& [a, b] : std::span(pairs).first(std::min(pairs.size(), kMaxListedIntersections)))
    report.self_intersection_positions.push_back(
        intersection_position(mesh.positions, mesh.triangles[a], mesh.triangles[b]));
}

}  // namespace isoatlas::detail
