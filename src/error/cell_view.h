// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "complex/c_vertex_graph.h"
#include "error/surfels.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// Where on the mesh a c-vertex finds itself: the closest point of the triangles that have a corner at its cell's site or at
/// a neighbour of it (paper, 3.5).
struct ClosestPoint {
  std::uint32_t triangle = 0;  ///< index into CellView::triangles
  std::array<float, 3> weight{};
  float distance = 0;
};

/// One cell of the partition with the mesh around it: all that a metric may look at. Lengths are world units over the voxel.
struct CellView {
  const Surfels& surfels;
  const CVertexGraph& graph;
  std::span<const float> geodesic;        ///< per c-vertex of the surface, distance to its site in G
  std::span<const CellId> cell_of;        ///< per c-vertex of the surface
  std::span<const Vec3> vertex_normal;    ///< per cell, unit normal of the isosurface at its site
  std::span<const Triangle> triangles;    ///< of the mesh, by their cells
  std::span<const Vec3> triangle_normal;  ///< per triangle, unit, outward; zero for one without area
  CVertexId site;
  std::span<const CVertexId> c_vertices;  ///< of the cell
  std::span<const ClosestPoint> closest;  ///< per c-vertex of the cell; only where needs_closest() of the metric
  float from_mesh = 0;                    ///< largest distance from the cell's mesh triangles to the surface
};

}  // namespace isoatlas::detail
