// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "complex/surface_complex.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// The paper's graph G of a surface complex: two c-vertices are neighbours iff they share a face;
/// weights are Euclidean distances. Built from the faces on demand, since partitions by blocks
/// never need it.
///
/// Row v lists the neighbours of v in the cyclic order of the faces around it: side, (diagonal,)
/// side, (diagonal,) ... For a boundary c-vertex the row runs from one boundary side to the other;
/// for others it is a cycle and starts anywhere.
struct CVertexGraph {
  struct Neighbour {
    CVertexId id;
    float weight;  ///< world length
    bool operator==(const Neighbour&) const = default;
  };
  std::vector<std::uint32_t> first;  ///< row v is [first[v], first[v + 1])
  std::vector<Neighbour> neighbours;
  std::vector<std::uint8_t>
      is_diagonal;  ///< parallel to neighbours: 1 across a quad, 0 along a side
  std::vector<std::uint8_t> on_boundary;  ///< per c-vertex

  std::uint32_t c_vertex_count() const { return static_cast<std::uint32_t>(first.size() - 1); }
  std::span<const Neighbour> row(CVertexId v) const {
    return {neighbours.data() + first[v], neighbours.data() + first[v + 1]};
  }
};

/// Added to the weight between a c-vertex on a shared face and one inside; in world lengths, longer
/// than any path in a block. So Voronoi cells of sites on shared faces contain nothing else:
/// otherwise the cells of two neighbours on a seam would be adjacent behind the one between them,
/// and the dual would have an edge on the shared face.
constexpr float kSeamWeight = 1e4f;

/// The length of an edge of the graph, without kSeamWeight.
inline float length_of(const CVertexGraph::Neighbour& n) {
  return n.weight < kSeamWeight ? n.weight : n.weight - kSeamWeight;
}

/// O(C + sum of valence log valence). 9 bytes per entry: about 6 entries per c-vertex of a triangle
/// complex, 8 of a quad one.
CVertexGraph make_graph(const SurfaceComplex& complex, const RunControl* control = nullptr);

/// Updates the graph of a complex that has changed. @pre c-vertices kept their ids
/// @return per c-vertex, 1 if its row has changed or is new
/// @cost   as make_graph()
std::vector<std::uint8_t> rebuild_graph(CVertexGraph& graph, const SurfaceComplex& complex,
                                        const RunControl* control = nullptr);

}  // namespace isoatlas::detail
