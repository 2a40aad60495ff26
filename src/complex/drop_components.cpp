// SPDX-License-Identifier: Apache-2.0
#include "complex/drop_components.h"

#include <algorithm>

namespace isoatlas::detail {

void drop_components(SurfaceComplex& complex, const Components& components,
                     const std::vector<std::uint8_t>& dropped) {
  const auto is_dropped = [&](CVertexId v) { return dropped[components.of_c_vertex[v]] != 0; };
  std::vector<CVertexId> new_id(complex.c_vertex_count(), kNone);
  CVertexId kept = 0;
  for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
    if (is_dropped(v)) continue;
    complex.positions[kept] = complex.positions[v];
    complex.on_boundary[kept] = complex.on_boundary[v];
    new_id[v] = kept++;
  }
  complex.positions.resize(kept);
  complex.on_boundary.resize(kept);
  std::erase_if(complex.faces, [&](const Face& f) { return new_id[f.corner[0]] == kNone; });
  for (Face& face : complex.faces) {
    for (int k = 0; k < face.size(); ++k) face.corner[k] = new_id[face.corner[k]];
  }
  std::erase_if(complex.boundary, [&](const BoundarySide& s) { return new_id[s.from] == kNone; });
  for (BoundarySide& s : complex.boundary) s = {new_id[s.from], new_id[s.to]};
}

}  // namespace isoatlas::detail
