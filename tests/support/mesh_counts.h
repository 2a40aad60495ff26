// SPDX-License-Identifier: Apache-2.0
// Counts a mesh independently of the product: shares nothing with src/.
#pragma once

#include <cstddef>
#include <string>

#include "isoatlas/mesh.h"
#include "isoatlas/report.h"

namespace isoatlas::detail::test {

struct MeshCounts {
  /// What is wrong first; empty for a consistently oriented manifold without unused vertices.
  std::string fault;
  std::size_t edges = 0;
  TopologySummary topology;  ///< only of a mesh without fault
};

/// Manifold: an edge in one or two triangles, and the triangles of a vertex in one fan. Genus from
/// the Euler characteristic of each component, loops by walking along the boundary.
MeshCounts count_mesh(const TriangleMesh& mesh);

}  // namespace isoatlas::detail::test
