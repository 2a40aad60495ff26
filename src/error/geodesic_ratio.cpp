// SPDX-License-Identifier: Apache-2.0
// Directional curvature 1 (paper, 3.5): the largest ratio of geodesic to straight distance between
// the site and a c-vertex on the boundary of the Voronoi cell. Ratio >= 1.
//
// Shortest paths in G zigzag, up to 8 % longer than geodesics even in a plane; so the section of
// the surface above the straight line is measured as well (its points projected onto the nearest
// surfel's tangent plane), and the shorter of the two counts: both are at least as long as the
// geodesic, up to the polygon's error.
#include <algorithm>
#include <vector>

#include "core/vector_math.h"
#include "error/cell_boundary.h"
#include "error/metrics.h"
#include "error/nearest_surfel.h"

namespace isoatlas::detail {
namespace {

constexpr int kPieces = 6;  // the length of a 90 degree arc comes out 0.3 % too short

double section_length(const CellView& cell, Vec3 from, Vec3 to) {
  double sum = 0;
  Vec3 last = from;
  CVertexId at = cell.site;
  for (int i = 1; i <= kPieces; ++i) {
    Vec3 p = to;
    if (i < kPieces) {
      const double t = static_cast<double>(i) / kPieces;
      p = (1 - t) * from + t * to;
      at = walk_to_nearest(cell.surfels, cell.graph, at, p).id;
      const Vec3 n = cell.surfels.normal[at];
      p = p - dot(p - cell.surfels.point[at], n) * n;
    }
    sum += length(p - last);
    last = p;
  }
  return sum;
}

}  // namespace

double geodesic_ratio(const CellView& cell) {
  struct Candidate {
    double bound;  // upper bound of the ratio at this c-vertex
    CVertexId c_vertex;
  };
  const Vec3 site = cell.surfels.point[cell.site];
  const auto straight_to = [&](CVertexId v) { return length(cell.surfels.point[v] - site); };
  std::vector<Candidate> candidates;
  for (const CVertexId v : cell.c_vertices) {
    const double straight = straight_to(v);
    if (straight > 0 && is_on_cell_boundary(cell, v))
      candidates.push_back({cell.geodesic[v] / straight, v});
  }
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& a, const Candidate& b) { return a.bound > b.bound; });
  double largest = 1;
  for (const Candidate& c : candidates) {
    if (c.bound <= largest) break;
    largest = std::max(
        largest, std::min(c.bound, section_length(cell, site, cell.surfels.point[c.c_vertex]) /
                                       straight_to(c.c_vertex)));
  }
  return largest;
}

}  // namespace isoatlas::detail
