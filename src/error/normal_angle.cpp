// SPDX-License-Identifier: Apache-2.0
// Directional curvature 2 (paper, 3.5): the angles between the normals of consecutive c-vertices
// are summed along the geodesic from the site to a c-vertex on the boundary of the Voronoi cell.
// The metric is the largest sum, in degrees.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/vector_math.h"
#include "error/cell_boundary.h"
#include "error/metrics.h"

namespace isoatlas::detail {
namespace {

// Uses the tangent of the half angle, which is also accurate for small angles.
double angle_between(Vec3 a, Vec3 b) { return 2 * std::atan2(length(a - b), length(a + b)); }

}  // namespace

double normal_angle(const CellView& cell) {
  // Nearest first, so that the previous c-vertex on the geodesic already has its sum.
  std::vector<CVertexId> order(cell.c_vertices.begin(), cell.c_vertices.end());
  const auto nearer = [&](CVertexId a, CVertexId b) {
    return cell.geodesic[a] != cell.geodesic[b] ? cell.geodesic[a] < cell.geodesic[b] : a < b;
  };
  std::sort(order.begin(), order.end(), nearer);
  std::vector<std::pair<CVertexId, double>>
      sums;  // sorted by c-vertex: cells list theirs in increasing order
  sums.reserve(order.size());
  for (const CVertexId v : cell.c_vertices) sums.emplace_back(v, 0.0);
  const auto sum_of = [&](CVertexId v) -> double& {
    return std::lower_bound(sums.begin(), sums.end(), v,
                            [](const auto& s, CVertexId id) { return s.first < id; })
        ->second;
  };
  double largest = 0;
  for (const CVertexId v : order) {
    if (v == cell.site) continue;
    CVertexId previous = kNone;
    float reached = 0;
    for (const CVertexGraph::Neighbour& n : cell.graph.row(v)) {
      if (cell.cell_of[n.id] != cell.cell_of[v] || !nearer(n.id, v)) continue;
      const float d = cell.geodesic[n.id] + n.weight;
      if (previous == kNone || d < reached) {
        previous = n.id;
        reached = d;
      }
    }
    if (previous == kNone)
      continue;  // its geodesic ran through c-vertices that another site owns now
    const double sum =
        sum_of(previous) + angle_between(cell.surfels.normal[previous], cell.surfels.normal[v]);
    sum_of(v) = sum;
    if (sum > largest && is_on_cell_boundary(cell, v)) largest = sum;
  }
  return largest * 180 / std::numbers::pi;
}

}  // namespace isoatlas::detail
