// SPDX-License-Identifier: Apache-2.0
#include "support/mesh_counts.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

namespace isoatlas::detail::test {
namespace {

/// The directed edges of all polygons, sorted.
std::vector<DirectedEdge> directed_edges(const std::vector<Polygon>& polygons) {
  std::vector<DirectedEdge> edges;
  for (const Polygon p : polygons)
    for (std::size_t k = 0; k < p.size(); ++k) edges.emplace_back(p[k], p[(k + 1) % p.size()]);
  std::sort(edges.begin(), edges.end());
  return edges;
}

bool contains(const std::vector<DirectedEdge>& sorted, DirectedEdge edge) {
  return std::binary_search(sorted.begin(), sorted.end(), edge);
}

// Walks around a vertex, starting at the boundary if there is one, and compares the number of
// polygons passed with all that it has. `next` has an entry per polygon of the vertex: from the
// corner after the vertex to the corner before it.
bool is_one_fan(const std::map<std::uint32_t, std::uint32_t>& next) {
  std::set<std::uint32_t> targets;
  for (const auto& [from, to] : next) targets.insert(to);
  std::uint32_t at = next.begin()->first;
  for (const auto& [from, to] : next)
    if (!targets.contains(from)) at = from;
  std::size_t passed = 0;
  const std::uint32_t start = at;
  for (auto it = next.find(at); it != next.end(); it = next.find(at)) {
    ++passed;
    at = it->second;
    if (at == start) break;
  }
  return passed == next.size();
}

std::string fault_of(std::size_t vertices, const std::vector<Polygon>& polygons,
                     const std::vector<DirectedEdge>& edges) {
  for (const Polygon p : polygons) {
    for (std::size_t k = 0; k < p.size(); ++k) {
      if (p[k] >= vertices) return "a corner is not a vertex";
      for (std::size_t l = 0; l < k; ++l)
        if (p[k] == p[l]) return "a polygon uses a vertex twice";
    }
  }
  // Also refuses edges in three polygons: two of them would have the same direction.
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end())
    return "two polygons have the same directed edge";
  std::vector<std::map<std::uint32_t, std::uint32_t>> around(vertices);
  for (const Polygon p : polygons) {
    const std::size_t n = p.size();
    for (std::size_t k = 0; k < n; ++k) around[p[k]][p[(k + 1) % n]] = p[(k + n - 1) % n];
  }
  for (const auto& next : around) {
    if (next.empty()) return "a vertex is in no polygon";
    if (!is_one_fan(next)) return "a vertex has more than one fan";
  }
  return "";
}

}  // namespace

MeshCounts count_polygons(std::size_t vertices, const std::vector<Polygon>& polygons) {
  MeshCounts out;
  const std::vector<DirectedEdge> edges = directed_edges(polygons);
  for (const auto& [from, to] : edges) {
    const bool has_twin = contains(edges, {to, from});
    if (!has_twin) out.boundary.emplace_back(from, to);
    out.edges += has_twin && from > to ? 0 : 1;
  }
  out.fault = fault_of(vertices, polygons, edges);
  if (!out.fault.empty()) return out;

  // Each vertex is labelled with the smallest one of its component.
  std::vector<std::uint32_t> label(vertices);
  std::iota(label.begin(), label.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (label[v] != v) v = label[v] = label[label[v]];
    return v;
  };
  for (const auto& [from, to] : edges) {
    const std::uint32_t a = root(from), b = root(to);
    label[std::max(a, b)] = std::min(a, b);
  }
  std::vector<std::uint32_t>& component = out.component_of_vertex;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const bool is_first = root(v) == v;
    component.push_back(is_first ? static_cast<std::uint32_t>(out.components.size())
                                 : component[root(v)]);
    if (is_first) out.components.emplace_back();
    out.components[component[v]].euler_characteristic += 1;
  }
  for (const Polygon p : polygons) out.components[component[p[0]]].euler_characteristic += 1;
  for (const auto& [from, to] : edges)
    if (from < to || !contains(edges, {to, from}))
      out.components[component[from]].euler_characteristic -= 1;
  std::map<std::uint32_t, std::uint32_t> left(out.boundary.begin(), out.boundary.end());
  while (!left.empty()) {
    const std::uint32_t start = left.begin()->first;
    out.components[component[start]].boundary_loops += 1;
    for (auto it = left.find(start); it != left.end();) {
      const std::uint32_t to = it->second;
      left.erase(it);
      it = left.find(to);
    }
  }

  std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> kinds;
  for (const ComponentTopology& c : out.components) {
    const std::int64_t twice_genus = 2 - c.boundary_loops - c.euler_characteristic;
    if (twice_genus % 2 != 0) throw std::logic_error("count_polygons: half a handle");
    ++kinds[{twice_genus / 2, c.boundary_loops}];
    ++out.topology.components;
    out.topology.euler_characteristic += c.euler_characteristic;
    out.topology.genus += twice_genus / 2;
    out.topology.boundary_loops += c.boundary_loops;
  }
  for (const auto& [kind, count] : kinds)
    out.topology.kinds.push_back({kind.first, kind.second, count});
  return out;
}

MeshCounts count_mesh(const TriangleMesh& mesh) {
  return count_polygons(mesh.positions.size(), {mesh.triangles.begin(), mesh.triangles.end()});
}

}  // namespace isoatlas::detail::test
