// SPDX-License-Identifier: Apache-2.0
// Inlined into the loops over all faces.
#include "core/vector_math.h"

namespace isoatlas::detail {

inline FaceCut cut_face(const SurfaceComplex& complex, const Face& face,
                        const std::array<CellId, 4>& c, std::span<const CVertexId> site) {
  FaceCut out;
  if (face.is_triangle()) {
    if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0])
      out.triangle[out.triangles++] = {{c[0], c[1], c[2]}, face.corner[0]};
    return out;
  }
  const auto corner_distance = [&](int i, int j) {
    return squared_distance(complex.positions[face.corner[i]], complex.positions[face.corner[j]],
                            complex.spacing);
  };
  const bool first = c[0] == c[2], second = c[1] == c[3];  // equal cells across the quad
  if (first || second) {
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[3] || c[3] == c[0])
      return out;  // already joined along a side, at most two cells
    const bool join_first = first && (!second || corner_distance(0, 2) <= corner_distance(1, 3));
    out.joined_corner = join_first ? 0 : 1;
    out.joined = c[out.joined_corner];
    return out;
  }
  // No equal cells across the quad. Equal neighbours: AABB and similar cases yield nothing, AABC
  // one triangle.
  for (int k = 0; k < 4; ++k) {
    if (c[k] != c[(k + 1) % 4]) continue;
    const CellId a = c[k], b = c[(k + 2) % 4], d = c[(k + 3) % 4];
    if (b != d) out.triangle[out.triangles++] = {{a, b, d}, face.corner[(k + 2) % 4]};
    return out;
  }
  double d02, d13;
  if (site.empty()) {
    d02 = corner_distance(0, 2);
    d13 = corner_distance(1, 3);
  } else {
    const auto site_distance = [&](int i, int j) {
      return squared_distance(complex.positions[site[c[i]]], complex.positions[site[c[j]]],
                              complex.spacing);
    };
    d02 = site_distance(0, 2);
    d13 = site_distance(1, 3);
  }
  if (d02 <= d13) {
    out.triangle = {DualTriangle{{c[0], c[1], c[2]}, face.corner[1]},
                    DualTriangle{{c[0], c[2], c[3]}, face.corner[3]}};
  } else {
    out.triangle = {DualTriangle{{c[1], c[2], c[3]}, face.corner[2]},
                    DualTriangle{{c[1], c[3], c[0]}, face.corner[0]}};
  }
  out.triangles = 2;
  return out;
}

}  // namespace isoatlas::detail
