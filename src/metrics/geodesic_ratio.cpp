// SPDX-License-Identifier: Apache-2.0
// Directional curvature 1 (paper, 3.5): geodesic over straight distance between the site and a c-vertex of the cell's border,
// the largest. Ratio >= 1.
//
// Shortest paths in G zigzag, up to 8 % longer than geodesics even in a plane; so the section of the surface above the straight
// line is measured as well (its points projected onto the nearest surfel's tangent plane), and the shorter of the two counts:
// both are at least as long as the geodesic, up to the polygon's error.
#include <algorithm>
#include <limits>

#include "core/vector_math.h"
#include "metrics/border.h"
#include "metrics/metrics.h"

namespace isoatlas {
namespace {

constexpr int kPieces = 6;  // an arc of 90 degrees comes out 0.3 % short

double section_length(const CellView& cell, Vec3 from, Vec3 to) {
  double sum = 0;
  Vec3 last = from;
  for (int i = 1; i <= kPieces; ++i) {
    Vec3 p = to;
    if (i < kPieces) {
      const double t = static_cast<double>(i) / kPieces;
      p = (1 - t) * from + t * to;
      double nearest = std::numeric_limits<double>::infinity();
      CVertexId at = cell.site;
      for (const CVertexId v : cell.c_vertices) {
        const double d = squared_length(cell.surfels.point[v] - p);
        if (d < nearest) {
          nearest = d;
          at = v;
        }
      }
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
  double largest = 1;
  const Vec3 site = cell.surfels.point[cell.site];
  for (const CVertexId v : cell.c_vertices) {
    const double straight = length(cell.surfels.point[v] - site);
    if (!(straight > 0) || cell.geodesic[v] <= largest * straight || !is_on_border(cell, v)) continue;
    const double geodesic = std::min<double>(cell.geodesic[v], section_length(cell, site, cell.surfels.point[v]));
    largest = std::max(largest, geodesic / straight);
  }
  return largest;
}

}  // namespace isoatlas
