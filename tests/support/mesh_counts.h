// SPDX-License-Identifier: Apache-2.0
// Counts a mesh independently of the product: shares nothing with src/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "isoatlas/mesh.h"
#include "isoatlas/report.h"

namespace isoatlas::detail::test {

using DirectedEdge = std::pair<std::uint32_t, std::uint32_t>;  ///< from, to
using Polygon = std::span<const std::uint32_t>;                ///< its corners once around

struct MeshCounts {
  /// What is wrong first; empty for a consistently oriented manifold without unused vertices.
  std::string fault;
  std::size_t edges = 0;
  // The rest is only of a mesh without fault.
  std::vector<DirectedEdge> boundary;  ///< the edges of one polygon, in its direction; sorted
  std::vector<std::uint32_t> component_of_vertex;  ///< numbered by smallest vertex
  std::vector<ComponentTopology> components;
  TopologySummary topology;  ///< of all components
};

/// Manifold: an edge in one or two polygons, and the polygons of a vertex in one fan. Genus from
/// the Euler characteristic of each component, loops by walking along the boundary.
MeshCounts count_polygons(std::size_t vertices, const std::vector<Polygon>& polygons);
MeshCounts count_mesh(const TriangleMesh& mesh);

}  // namespace isoatlas::detail::test
