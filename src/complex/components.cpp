// SPDX-License-Identifier: Apache-2.0
#include "complex/components.h"

#include "core/disjoint_sets.h"
#include "core/parallel.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kFacesToJoinPerChunk = 16384;  // faces per piece of a parallel loop

}  // namespace

std::vector<std::uint8_t> open_flags(const Components& components) {
  std::vector<std::uint8_t> is_open;
  is_open.reserve(components.topology.size());
  for (const ComponentTopology& topology : components.topology)
    is_open.push_back(topology.boundary_loops > 0 ? 1 : 0);
  return is_open;
}

Components find_components(const SurfaceComplex& complex) {
  const std::uint32_t n = complex.c_vertex_count();
  DisjointSets sets(n);
  for_each_index(complex.faces.size(), kFacesToJoinPerChunk, [&](std::size_t f) {
    const Face& face = complex.faces[f];
    sets.unite(face.corner[0], face.corner[1]);
    sets.unite(face.corner[1], face.corner[2]);
    if (!face.is_triangle()) sets.unite(face.corner[2], face.corner[3]);
  });
  Components out;
  out.of_c_vertex.resize(n);
  std::vector<std::int64_t> twice_euler;  // every side is counted half from each of its faces
  for (CVertexId v = 0; v < n; ++v) {
    const CVertexId root = sets.find(v);
    if (root == v) {
      out.of_c_vertex[v] = static_cast<ComponentId>(twice_euler.size());
      twice_euler.push_back(0);
    } else {
      out.of_c_vertex[v] = out.of_c_vertex[root];
    }
    twice_euler[out.of_c_vertex[v]] += 2;
  }
  for (const Face& face : complex.faces)
    twice_euler[out.of_c_vertex[face.corner[0]]] += 2 - face.size();
  for (const BoundarySide& s : complex.boundary) twice_euler[out.of_c_vertex[s.from]] -= 1;

  out.topology.resize(twice_euler.size());
  for (std::size_t c = 0; c < twice_euler.size(); ++c)
    out.topology[c].euler_characteristic = twice_euler[c] / 2;

  // Every boundary c-vertex has one boundary side in and one out, so loops are the components of
  // the boundary sides.
  DisjointSets loops(complex.boundary.empty() ? 0 : n);
  for (const BoundarySide& s : complex.boundary) loops.unite(s.from, s.to);
  for (const BoundarySide& s : complex.boundary) {
    if (loops.find(s.from) == s.from) ++out.topology[out.of_c_vertex[s.from]].boundary_loops;
  }
  return out;
}

}  // namespace isoatlas::detail
