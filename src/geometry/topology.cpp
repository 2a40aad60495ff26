// SPDX-License-Identifier: Apache-2.0
// Topology of a list of triangles, counted from the list alone: the independent check of every
// mesh.
#include <algorithm>
#include <new>
#include <string>

#include "core/cancel_poll.h"
#include "core/disjoint_sets.h"
#include "core/ids.h"
#include "geometry/require_corners.h"
#include "isoatlas/mesh.h"

namespace isoatlas {
using namespace detail;
namespace {

struct HalfEdge {
  std::uint32_t low, high;  // end vertices, low < high
  std::uint32_t forward;    // 1 if the triangle runs from low to high
};

// Stable counting sort by one key in [0, n).
template <class Key>
std::vector<HalfEdge> sorted_by(const std::vector<HalfEdge>& in, std::size_t n, Key key) {
  std::vector<std::uint32_t> first(n + 1, 0);
  for (const HalfEdge& h : in) ++first[key(h) + 1];
  for (std::size_t i = 0; i < n; ++i) first[i + 1] += first[i];
  std::vector<HalfEdge> out(in.size());
  for (const HalfEdge& h : in) out[first[key(h)]++] = h;
  return out;
}

}  // namespace

std::int64_t MeshTopology::euler_characteristic() const {
  std::int64_t sum = 0;
  for (const ComponentTopology& c : components) sum += c.euler_characteristic;
  return sum;
}
std::int64_t MeshTopology::genus() const {
  std::int64_t sum = 0;
  for (const ComponentTopology& c : components) sum += c.genus();
  return sum;
}
std::int64_t MeshTopology::boundary_loops() const {
  std::int64_t sum = 0;
  for (const ComponentTopology& c : components) sum += c.boundary_loops;
  return sum;
}

MeshTopology mesh_topology(const MeshView& mesh, const RunControl& control) try {
  MeshTopology out;
  const std::uint32_t n = checked_id(mesh.positions.size(), "vertices");
  checked_id(3 * mesh.triangles.size(), "triangle corners");
  require_corners(mesh);
  out.vertices = n;
  out.triangles = mesh.triangles.size();

  std::vector<HalfEdge> half_edges;
  half_edges.reserve(3 * mesh.triangles.size());
  DisjointSets sets(n);
  std::vector<std::uint32_t> corners(n, 0);  // triangles at each vertex
  CancelPoll poll(control);
  for (const Triangle& t : mesh.triangles) {
    poll.step();
    sets.unite(t[0], t[1]);
    sets.unite(t[1], t[2]);
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
      ++out.degenerate_triangles;
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      ++corners[a];
      half_edges.push_back({std::min(a, b), std::max(a, b), a < b ? 1u : 0u});
    }
  }

  // Components of the used vertices, numbered by smallest vertex.
  std::vector<bool> used(n, false);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) used[v] = true;
  }
  out.component_of_vertex.assign(n, kNone);
  for (std::uint32_t v = 0; v < n; ++v) {
    if (!used[v]) {
      ++out.unused_vertices;
      continue;
    }
    const std::uint32_t root = sets.find(v);
    if (root == v) {
      out.component_of_vertex[v] = static_cast<std::uint32_t>(out.components.size());
      out.components.emplace_back();
    } else {
      out.component_of_vertex[v] = out.component_of_vertex[root];
    }
    out.components[out.component_of_vertex[v]].euler_characteristic += 1;
  }
  for (const Triangle& t : mesh.triangles)
    out.components[out.component_of_vertex[t[0]]].euler_characteristic += 1;

  // Edges, sorted by (low, high).
  control.check_cancelled();
  half_edges = sorted_by(half_edges, n, [](const HalfEdge& h) { return h.high; });
  control.check_cancelled();
  half_edges = sorted_by(half_edges, n, [](const HalfEdge& h) { return h.low; });
  DisjointSets loops(n);  // boundary vertices joined along boundary edges
  std::vector<std::uint32_t> degree(n, 0), boundary_degree(n, 0);
  for (std::size_t i = 0; i < half_edges.size();) {
    poll.step();
    std::size_t j = i;
    std::uint32_t forward = 0;
    while (j < half_edges.size() && half_edges[j].low == half_edges[i].low &&
           half_edges[j].high == half_edges[i].high) {
      forward += half_edges[j++].forward;
    }
    const std::uint32_t a = half_edges[i].low, b = half_edges[i].high;
    ++out.edges;
    out.components[out.component_of_vertex[a]].euler_characteristic -= 1;
    ++degree[a];
    ++degree[b];
    if (j - i == 1) {
      ++out.boundary_edges;
      ++boundary_degree[a];
      ++boundary_degree[b];
      loops.unite(a, b);
    } else if (j - i == 2) {
      if (forward != 1) ++out.inconsistent_edges;
    } else {
      ++out.non_manifold_edges;
    }
    i = j;
  }
  for (std::uint32_t v = 0; v < n; ++v) {
    if (boundary_degree[v] > 0 && loops.find(v) == v)
      ++out.components[out.component_of_vertex[v]].boundary_loops;
  }

  // A vertex is regular iff its triangles form one fan: chain them across shared edges around the
  // vertex. If every edge at the vertex is in at most two triangles, the link is a union of paths
  // and cycles; it is connected iff all opposite edges are connected.
  std::vector<std::uint32_t> first(n + 1, 0);
  for (std::uint32_t v = 0; v < n; ++v) first[v + 1] = first[v] + corners[v];
  std::vector<std::array<std::uint32_t, 2>> link(first[n]);
  {
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (const Triangle& t : mesh.triangles) {
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      for (int k = 0; k < 3; ++k) link[next[t[k]]++] = {t[(k + 1) % 3], t[(k + 2) % 3]};
    }
  }
  std::vector<std::uint32_t> local(n, kNone);  // position of a neighbour in the current link
  for (std::uint32_t v = 0; v < n; ++v) {
    if (corners[v] == 0) continue;
    poll.step();
    DisjointSets fans(degree[v]);
    std::uint32_t count = 0;
    std::uint32_t joined = 0;
    for (std::uint32_t i = first[v]; i < first[v + 1]; ++i) {
      for (const std::uint32_t w : link[i]) {
        if (local[w] == kNone) local[w] = count++;
      }
      const std::uint32_t a = fans.find(local[link[i][0]]), b = fans.find(local[link[i][1]]);
      if (a != b) {
        fans.unite(a, b);
        ++joined;
      }
    }
    if (count - joined != 1 || boundary_degree[v] > 2) ++out.non_manifold_vertices;
    for (std::uint32_t i = first[v]; i < first[v + 1]; ++i) {
      for (const std::uint32_t w : link[i]) local[w] = kNone;
    }
  }
  return out;
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory to count this mesh");
}

}  // namespace isoatlas
