// SPDX-License-Identifier: Apache-2.0
#include "isosurface/cell_points.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

// Nodes keep this distance from the ends of their grid edge, and c-vertices from the walls of their
// cell, so that no two c-vertices coincide where samples equal the isovalue.
constexpr double kMargin = 1e-3;

// Where the surface crosses a grid edge, as a fraction of it.
double node_parameter(double low, double high) {
  const double t = low / (low - high);
  return t > kMargin ? std::min(t, 1 - kMargin) : kMargin;  // also for a NaN of 0/0
}

// The same for the spline through four values; the edge is between the middle two.
double node_parameter(const std::array<double, 4>& f, double start) {
  const double t = zero_between(f[1] >= f[2], start, [&](double s) {
    const CubicWeights w(s);
    return std::pair(weighted(w.value, f.data()), weighted(w.slope, f.data()));
  });
  return std::clamp(t, kMargin, 1 - kMargin);
}

template <class Cell>
Vec3 onto_surface_of(const Cell& cell, const Vec3 start, Vec3 spacing) {
  Vec3 best = start, p = start;
  double best_value = std::abs(cell.value(start));
  double value = cell.value(start);
  for (int step = 0; step < 2 && best_value > 0; ++step) {
    const Vec3 g = cell.gradient(p);
    const Vec3 direction{g.x / (spacing.x * spacing.x), g.y / (spacing.y * spacing.y),
                         g.z / (spacing.z * spacing.z)};
    const double slope = dot(g, direction);
    if (!(slope > 0)) break;
    const double s = value / slope;
    p = clamp_off_walls(p - s * direction);
    value = cell.value(p);
    if (!(std::abs(value) < best_value)) break;
    best_value = std::abs(value);
    best = p;
  }
  return best;
}

}  // namespace

Vec3 node_in_cell(const CellValues& cell, int edge) {
  const auto [low, high] = edge_corners(edge);
  const int axis = edge / 4;
  double t = node_parameter(cell.corner[low], cell.corner[high]);
  if (cell.cubic) t = node_parameter(cell.cubic->along(low, axis), t);
  Vec3 p{static_cast<double>(low & 1), static_cast<double>(low >> 1 & 1),
         static_cast<double>(low >> 2 & 1)};
  (axis == 0 ? p.x : axis == 1 ? p.y : p.z) = t;
  return p;
}

unsigned cut_edges(const CellLoops& loops) {
  unsigned out = 0;
  for (unsigned e = 0; e < 12; ++e) {
    if (loops.surfel_of_edge[e] != loops.other_surfel_of_edge[e]) out |= 1u << e;
  }
  return out;
}

Vec3 clamp_off_walls(Vec3 p) {
  const auto clamp = [](double x) { return std::clamp(x, kMargin, 1 - kMargin); };
  return {clamp(p.x), clamp(p.y), clamp(p.z)};
}

Vec3 onto_surface(const CellValues& cell, Vec3 start, Vec3 spacing) {
  return cell.cubic ? onto_surface_of(*cell.cubic, start, spacing)
                    : onto_surface_of(TrilinearCell(cell.corner), start, spacing);
}

}  // namespace isoatlas::detail
