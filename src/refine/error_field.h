// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "metrics/metrics.h"
#include "refine/level_mesh.h"

namespace isoatlas {

/// Everything of the surface that measuring needs and that does not change.
struct MeasuredSurface {
  const Surfels& surfels;
  const CVertexGraph& graph;
  std::span<const float> reach;  ///< per c-vertex, distance to its farthest neighbour in G
};

/// Finds, for the c-vertices of some cells, the closest points of the mesh: out[i] belongs to the i-th c-vertex of the cells
/// taken one after the other. Parallel over cells.
void find_closest(const MeasuredSurface& surface, const LevelMesh& mesh, std::span<const CellId> cells, std::vector<ClosestPoint>& out);

/// Distances from samples of the triangles of some cells to the surface: for each of these cells the largest, at samples that
/// are nearest to a c-vertex of the cell. The surface is taken as the surfels' tangent planes. Other cells' entries stay.
void measure_from_mesh(const MeasuredSurface& surface, const LevelMesh& mesh, std::span<const CellId> cell_of,
                       std::span<const CellId> cells, std::vector<float>& from_mesh);

}  // namespace isoatlas
