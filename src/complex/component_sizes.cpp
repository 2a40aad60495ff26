// SPDX-License-Identifier: Apache-2.0
#include "complex/component_sizes.h"

#include <cmath>

#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

// Of closed components.
std::vector<double> enclosed_volumes(const SurfaceComplex& complex, const Components& components) {
  const std::size_t n = components.topology.size();
  std::vector<double> six_volumes(n, 0);
  std::vector<CVertexId> first(n, kNone);  // seen from a point of the component, so that far ones lose no digits
  for (CVertexId v = complex.c_vertex_count(); v-- > 0;) first[components.of_c_vertex[v]] = v;
  for (const Face& face : complex.faces) {
    const ComponentId c = components.of_c_vertex[face.corner[0]];
    const Vec3 origin = complex.positions[first[c]];
    const auto at = [&](int k) { return scaled(complex.positions[face.corner[k]] - origin, complex.spacing); };
    for (int k = 2; k < face.size(); ++k) six_volumes[c] += dot(at(0), cross(at(k - 1), at(k)));
  }
  for (double& volume : six_volumes) volume = std::abs(volume) / 6;
  return six_volumes;
}

}  // namespace

ComponentSizes component_sizes(const SurfaceComplex& complex, const Components& components, const SurfaceComplex& closed) {
  ComponentSizes sizes;
  sizes.part_of.assign(components.topology.size(), kNone);
  if (&closed == &complex) {
    for (ComponentId c = 0; c < sizes.part_of.size(); ++c) sizes.part_of[c] = c;
    sizes.enclosed = enclosed_volumes(complex, components);
    return sizes;
  }
  // Both list the c-vertices of the cells within the volume in the same order and at the same places; those on the border and on
  // caps are elsewhere. Every component has one within the volume.
  const Components parts = find_components(closed);
  CVertexId there = 0;
  for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
    if (complex.on_boundary[v]) continue;
    CVertexId same = there;
    while (same < closed.c_vertex_count() && !(closed.positions[same] == complex.positions[v])) ++same;
    if (same == closed.c_vertex_count()) break;  // c-vertices of divided faces, at the end of both
    there = same + 1;
    sizes.part_of[components.of_c_vertex[v]] = parts.of_c_vertex[same];
  }
  sizes.enclosed = enclosed_volumes(closed, parts);
  return sizes;
}

}  // namespace isoatlas::detail
