// SPDX-License-Identifier: Apache-2.0
#include "simplify/collapse_plan.h"

#include <algorithm>
#include <cmath>

#include "core/ranges.h"
#include "geometry/closest_point.h"

namespace isoatlas::detail {
namespace {

// Smallest cosine of the angle between the normals of a new triangle and of the star it replaces.
constexpr double kMinCosine = 0.2;

}  // namespace

// @return false if the star has no normal
bool CollapsePlanner::measure_star() {
  const Vec3 p = mesh_.point(vertex_);
  Vec3 area;
  shape_ = std::numeric_limits<double>::infinity();
  for (const Link::Edge& edge : link_.edges()) {
    const Vec3 a = mesh_.point(edge.from), b = mesh_.point(edge.to);
    area = area + cross(a - p, b - p);
    shape_ = std::min(shape_, limits_.shape.score(p, a, b));
  }
  normal_ = normalized(area);
  return squared_length(normal_) > 0;
}

// @return false if the fan violates a limit
bool CollapsePlanner::measure_fan(std::uint32_t target, Fan& fan) const {
  const Vec3 p = mesh_.point(vertex_), apex = mesh_.point(target);
  fan = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  double squared_distance = std::numeric_limits<double>::infinity();
  for (const Link::Edge& edge : link_.edges()) {
    if (edge.from == target || edge.to == target) continue;
    const Vec3 a = mesh_.point(edge.from), b = mesh_.point(edge.to);
    const Vec3 area = cross(a - apex, b - apex);
    if (!(dot(area, normal_) > kMinCosine * length(area))) return false;
    const double longest = std::max(squared_length(a - apex), squared_length(b - apex));
    if (longest > limits_.max_edge * limits_.max_edge) return false;
    fan.shape = std::min(fan.shape, limits_.shape.score(apex, a, b));
    squared_distance =
        std::min(squared_distance, closest_on_triangle(p, apex, a, b).squared_distance);
  }
  fan.distance = std::sqrt(squared_distance);
  return fan.shape >= std::min(1.0, shape_) && fan.distance <= limits_.max_distance;
}

PlannedCollapse CollapsePlanner::plan(std::uint32_t vertex,
                                      std::span<const std::uint32_t> excluded) {
  PlannedCollapse best;
  link_.set(mesh_, vertex);
  vertex_ = vertex;
  if (link_.edges().empty() || !measure_star()) return best;
  const unsigned faces = box_.containing(mesh_.positions()[vertex]);
  double best_shape = -1;
  for (const std::uint32_t target : link_.vertices()) {
    Fan fan;
    if (ranges::count(excluded, target) > 0 ||
        (faces & ~box_.containing(mesh_.positions()[target])) != 0 || !measure_fan(target, fan))
      continue;
    const double shape = std::min(1.0, fan.shape);
    const bool is_better = shape != best_shape ? shape > best_shape : fan.distance < best.cost;
    if (!is_better || !link_.permits(mesh_, target)) continue;
    best = {{vertex, target}, fan.distance};
    best_shape = shape;
  }
  return best;
}

bool CollapsePlanner::is_possible(const Collapse& collapse) {
  link_.set(mesh_, collapse.vertex);
  return link_.permits(mesh_, collapse.target);
}

}  // namespace isoatlas::detail
