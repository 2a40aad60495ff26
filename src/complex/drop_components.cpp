// SPDX-License-Identifier: Apache-2.0
#include "complex/drop_components.h"

#include <algorithm>

namespace isoatlas::detail {

void drop_components(SurfaceComplex& complex, const Components& components, const std::vector<std::uint8_t>& dropped) {
  const auto goes = [&](CVertexId v) { return dropped[components.of_c_vertex[v]] != 0; };
  std::vector<CVertexId> now(complex.c_vertex_count(), kNone);
  CVertexId kept = 0;
  for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
    if (goes(v)) continue;
    complex.positions[kept] = complex.positions[v];
    complex.on_boundary[kept] = complex.on_boundary[v];
    now[v] = kept++;
  }
  complex.positions.resize(kept);
  complex.on_boundary.resize(kept);
  std::erase_if(complex.faces, [&](const Face& f) { return now[f.corner[0]] == kNone; });
  for (Face& face : complex.faces) {
    for (int k = 0; k < face.size(); ++k) face.corner[k] = now[face.corner[k]];
  }
  std::erase_if(complex.boundary, [&](const BoundarySide& s) { return now[s.from] == kNone; });
  for (BoundarySide& s : complex.boundary) s = {now[s.from], now[s.to]};
}

}  // namespace isoatlas::detail
