// SPDX-License-Identifier: Apache-2.0
#include "components.h"

#include <algorithm>
#include <functional>
#include <limits>

#include "core/vector_math.h"

namespace isoatlas::detail::python {
namespace {

void extend(ComponentFacts& component, Vec3 p) {
  const auto low = [](double& bound, double value) { bound = std::min(bound, value); };
  const auto high = [](double& bound, double value) { bound = std::max(bound, value); };
  low(component.low.x, p.x), low(component.low.y, p.y), low(component.low.z, p.z);
  high(component.high.x, p.x), high(component.high.y, p.y), high(component.high.z, p.z);
}

/// Counts the vertices of each component and finds its bounding box.
std::vector<ComponentFacts> with_vertices(const MeshView& mesh, const MeshTopology& topology) {
  std::vector<ComponentFacts> components;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const std::size_t c = topology.component_of_vertex[v];
    if (c == 0xFFFFFFFF) continue;  // an unused vertex
    const Vec3 p = mesh.positions[v];
    if (c == components.size()) {  // components are numbered by their smallest vertex
      components.emplace_back().first_vertex = v;
      components.back().low = components.back().high = p;
    }
    ++components[c].vertices;
    extend(components[c], p);
  }
  return components;
}

/// Adds areas and volumes. Volumes are sums of tetrahedra with a common corner on the component, so
/// that components far from the origin keep their digits.
void add_triangles(std::vector<ComponentFacts>& components, const MeshView& mesh,
                   const MeshTopology& topology) {
  for (const Triangle& t : mesh.triangles) {
    ComponentFacts& component = components[topology.component_of_vertex[t[0]]];
    const Vec3 corner = mesh.positions[component.first_vertex];
    const Vec3 a = mesh.positions[t[0]] - corner;
    const Vec3 b = mesh.positions[t[1]] - corner;
    const Vec3 c = mesh.positions[t[2]] - corner;
    const Vec3 normal = cross(b - a, c - a);
    ++component.triangles;
    component.area += length(normal) / 2;
    component.volume += dot(a, cross(b, c)) / 6;
  }
}

}  // namespace

std::vector<ComponentFacts> components_of(const MeshView& mesh) {
  const MeshTopology topology = mesh_topology(mesh);
  std::vector<ComponentFacts> components = with_vertices(mesh, topology);
  add_triangles(components, mesh, topology);
  const bool has_topology = topology.is_manifold() && topology.is_oriented();
  for (std::size_t c = 0; c < components.size(); ++c) {
    if (has_topology) components[c].topology = topology.components[c];
    if (!has_topology || topology.components[c].boundary_loops > 0)
      components[c].volume = std::numeric_limits<double>::quiet_NaN();
  }
  std::ranges::stable_sort(components, std::greater(), &ComponentFacts::area);
  return components;
}

}  // namespace isoatlas::detail::python
