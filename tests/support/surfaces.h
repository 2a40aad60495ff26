// SPDX-License-Identifier: Apache-2.0
// Surfaces and meshes for tests, and measures of them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "complex/c_vertex_graph.h"
#include "complex/surface_complex.h"
#include "isoatlas/mesh.h"
#include "support/mesh_counts.h"
#include "support/volumes.h"

namespace isoatlas::detail::test {

/// The parsed surface of generated samples; the test fails if it is not valid.
SurfaceComplex surface_of(const Samples& samples, double isovalue = 0,
                          Inside inside = Inside::above, Vec3 spacing = {1, 1, 1},
                          Topology topology = Topology::trilinear);

/// Splits quads along one diagonal.
TriangleMesh triangles_of(const SurfaceComplex& complex);
/// Counts without a fault; of a surface complex, also its boundary sides and flags are right.
/// @throws std::runtime_error if it has a fault
MeshCounts count_manifold(const TriangleMesh& mesh);
MeshCounts count_manifold(const SurfaceComplex& complex);
/// The (genus, loops) of a mesh's components, by count_manifold().
std::vector<TopologySummary::Kind> kinds_of(const TriangleMesh& mesh);
std::string text(const std::vector<TopologySummary::Kind>& kinds);

/// A flat disk of n x m c-vertices: the surface of a half-space z <= 0.5 in an n x m x 2 volume
/// without the c-vertices in the boundary layer. Built by hand, so that positions and weights are
/// whole numbers. C-vertex (x, y) is x + n y.
SurfaceComplex flat_grid(std::uint32_t n, std::uint32_t m);
/// The same, closed in x to a tube of circumference n (positions on a circle of that
/// circumference).
SurfaceComplex tube(std::uint32_t n, std::uint32_t m);
SurfaceComplex tetrahedron();

/// Six times the volume is the sum over triangles of det(a, b, c); positive if triangles face
/// outwards.
double signed_volume(const TriangleMesh& mesh);
std::pair<Vec3, Vec3> bounding_box(const TriangleMesh& mesh);

/// Shortest paths in the graph by Bellman-Ford in double precision: slow, and independent of the
/// code it checks.
std::vector<double> slow_distances(const CVertexGraph& graph,
                                   const std::vector<CVertexId>& sources);

}  // namespace isoatlas::detail::test
