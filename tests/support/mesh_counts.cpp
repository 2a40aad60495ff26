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

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// The directed edges of all triangles, sorted.
std::vector<Edge> directed_edges(const TriangleMesh& mesh) {
  std::vector<Edge> edges;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(t[k], t[(k + 1) % 3]);
  std::sort(edges.begin(), edges.end());
  return edges;
}

bool contains(const std::vector<Edge>& sorted, Edge edge) {
  return std::binary_search(sorted.begin(), sorted.end(), edge);
}

// Walks from the edge that leaves the vertex first (a boundary edge if there is one) around it, and
// compares the triangles passed with all that it has. `next` holds, per vertex, the edges opposite
// to it as pairs (from, to).
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

std::string fault_of(const TriangleMesh& mesh, const std::vector<Edge>& edges) {
  std::vector<std::map<std::uint32_t, std::uint32_t>> opposite(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (t[k] >= mesh.positions.size()) return "a corner is not a vertex";
      if (t[k] == t[(k + 1) % 3]) return "a triangle uses a vertex twice";
    }
  }
  // Also refuses edges in three triangles: two of them would have the same direction.
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end())
    return "two triangles have the same directed edge";
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) opposite[t[k]][t[(k + 1) % 3]] = t[(k + 2) % 3];
  for (const auto& next : opposite) {
    if (next.empty()) return "a vertex is in no triangle";
    if (!is_one_fan(next)) return "a vertex has more than one fan";
  }
  return "";
}

struct Component {
  std::int64_t euler = 0, loops = 0;
};

}  // namespace

MeshCounts count_mesh(const TriangleMesh& mesh) {
  MeshCounts out;
  const std::vector<Edge> edges = directed_edges(mesh);
  std::map<std::uint32_t, std::uint32_t> boundary;  // from, to: at most one for each vertex
  for (const auto& [from, to] : edges) {
    const bool has_twin = contains(edges, {to, from});
    if (!has_twin) boundary[from] = to;
    out.edges += has_twin && from > to ? 0 : 1;
  }
  out.fault = fault_of(mesh, edges);
  if (!out.fault.empty()) return out;

  // Each vertex is labelled with the smallest one of its component.
  std::vector<std::uint32_t> label(mesh.positions.size());
  std::iota(label.begin(), label.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (label[v] != v) v = label[v] = label[label[v]];
    return v;
  };
  for (const auto& [from, to] : edges) {
    const std::uint32_t a = root(from), b = root(to);
    label[std::max(a, b)] = std::min(a, b);
  }
  std::map<std::uint32_t, Component> components;
  for (std::uint32_t v = 0; v < label.size(); ++v) components[root(v)].euler += 1;
  for (const Triangle& t : mesh.triangles) components[root(t[0])].euler += 1;
  for (const auto& [from, to] : edges)
    if (from < to || !contains(edges, {to, from})) components[root(from)].euler -= 1;
  while (!boundary.empty()) {
    const std::uint32_t start = boundary.begin()->first;
    components[root(start)].loops += 1;
    for (auto it = boundary.find(start); it != boundary.end();) {
      const std::uint32_t to = it->second;
      boundary.erase(it);
      it = boundary.find(to);
    }
  }

  std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> kinds;
  for (const auto& [first, c] : components) {
    if ((2 - c.loops - c.euler) % 2 != 0) throw std::logic_error("count_mesh: half a handle");
    const std::int64_t genus = (2 - c.loops - c.euler) / 2;
    ++kinds[{genus, c.loops}];
    ++out.topology.components;
    out.topology.euler_characteristic += c.euler;
    out.topology.genus += genus;
    out.topology.boundary_loops += c.loops;
  }
  for (const auto& [kind, count] : kinds)
    out.topology.kinds.push_back({kind.first, kind.second, count});
  return out;
}

}  // namespace isoatlas::detail::test
