// SPDX-License-Identifier: Apache-2.0
#include "complex/component_sizes.h"

#include <cmath>

#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

// The volumes that closed components enclose.
std::vector<double> enclosed_volumes(const SurfaceComplex& complex, const Components& components) {
  const std::size_t n = components.topology.size();
  std::vector<double> six_volumes(n, 0);
  // volumes are computed relative to a point of the component, so that distant ones lose no digits
  std::vector<CVertexId> first(n, kNone);
  for (CVertexId v = complex.c_vertex_count(); v-- > 0;) first[components.of_c_vertex[v]] = v;
  for (const Face& face : complex.faces) {
    const ComponentId c = components.of_c_vertex[face.corner[0]];
    const Vec3 origin = complex.positions[first[c]];
    const auto at = [&](int k) {
      return to_metric(complex.positions[face.corner[k]] - origin, complex.spacing);
    };
    for (int k = 2; k < face.size(); ++k) six_volumes[c] += dot(at(0), cross(at(k - 1), at(k)));
  }
  for (double& volume : six_volumes) volume = std::abs(volume) / 6;
  return six_volumes;
}

}  // namespace

ComponentSizes component_sizes(const SurfaceComplex& complex, const Components& components,
                               const SurfaceComplex& closed, const Components& parts) {
  ComponentSizes sizes;
  sizes.part_of.assign(components.topology.size(), kNone);
  if (&closed == &complex) {
    for (ComponentId c = 0; c < sizes.part_of.size(); ++c) sizes.part_of[c] = c;
    sizes.enclosed = enclosed_volumes(complex, components);
    return sizes;
  }
  // Both complexes list the c-vertices of grid cells inside the volume in the same order and with
  // the same positions; those on the volume boundary and on caps differ. Every component has a
  // c-vertex inside the volume.
  CVertexId next = 0;
  for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
    if (complex.on_boundary[v]) continue;
    CVertexId counterpart = next;
    while (counterpart < closed.c_vertex_count() &&
           !(closed.positions[counterpart] == complex.positions[v]))
      ++counterpart;
    if (counterpart == closed.c_vertex_count())
      break;  // c-vertices of split faces, at the end of both
    next = counterpart + 1;
    sizes.part_of[components.of_c_vertex[v]] = parts.of_c_vertex[counterpart];
  }
  sizes.enclosed = enclosed_volumes(closed, parts);
  return sizes;
}

}  // namespace isoatlas::detail
