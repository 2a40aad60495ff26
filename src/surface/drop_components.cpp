// SPDX-License-Identifier: Apache-2.0
#include "surface/drop_components.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/vector_math.h"

namespace isoatlas {

std::vector<double> component_volumes(const SurfaceComplex& complex, const Components& components) {
  const std::size_t n = components.topology.size();
  std::vector<double> six_volumes(n, 0), areas(n, 0);
  std::vector<CVertexId> first(n, kNone);  // seen from a point of the component, so that far ones lose no digits
  for (CVertexId v = complex.c_vertex_count(); v-- > 0;) first[components.of_c_vertex[v]] = v;
  for (const Face& face : complex.faces) {
    const ComponentId c = components.of_c_vertex[face.corner[0]];
    const Vec3 origin = complex.positions[first[c]];
    const auto at = [&](int k) { return scaled(complex.positions[face.corner[k]] - origin, complex.spacing); };
    for (int k = 2; k < face.size(); ++k) {
      const Vec3 area = cross(at(k - 1) - at(0), at(k) - at(0));
      six_volumes[c] += dot(at(0), area);
      areas[c] += 0.5 * length(area);
    }
  }
  std::vector<double> out(n);
  for (std::size_t c = 0; c < n; ++c) {
    const bool closed = components.topology[c].boundary_loops == 0;
    out[c] = closed ? std::abs(six_volumes[c]) / 6 : std::pow(areas[c], 1.5) / (6 * std::sqrt(std::numbers::pi));
  }
  return out;
}

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

}  // namespace isoatlas
