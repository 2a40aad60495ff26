// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "complex/c_vertex_graph.h"
#include "error/surfels.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// The point of the mesh closest to a c-vertex, among the triangles that have a corner at its
/// cell's vertex or at a neighbour of that (paper, 3.5).
struct ClosestPoint {
  std::uint32_t triangle = 0;  ///< index into CellView::triangles
  std::array<float, 3> weight{};
  float distance = 0;
};

/// One Voronoi cell with the mesh around it: everything that a metric may use. Lengths are in
/// voxels (smallest spacings).
struct CellView {
  const Surfels& surfels;
  const CVertexGraph& graph;
  std::span<const float> geodesic;  ///< per c-vertex of the surface, its distance to its site in G
  std::span<const CellId> cell_of;  ///< per c-vertex of the surface
  std::span<const Vec3> vertex_normal;  ///< per cell, unit normal of the isosurface at its site
  std::span<const Triangle> triangles;  ///< of the mesh; corners are cells
  std::span<const Vec3>
      triangle_normal;  ///< per triangle, unit, outward; zero for triangles without area
  CVertexId site;
  std::span<const CVertexId> c_vertices;  ///< of the cell
  std::span<const ClosestPoint>
      closest;          ///< per c-vertex of the cell; only filled if needs_closest() of the metric
  float from_mesh = 0;  ///< largest distance from the cell's mesh triangles to the surface
};

}  // namespace isoatlas::detail
