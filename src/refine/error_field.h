// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "measure/isosurface.h"
#include "metrics/metrics.h"
#include "refine/level_mesh.h"

namespace isoatlas {

/// Everything of the surface that measuring needs and that does not change.
struct MeasuredSurface {
  const Surfels& surfels;
  const CVertexGraph& graph;
  std::span<const float> reach;  ///< per c-vertex, distance to its farthest neighbour in G
  Vec3 spacing;
  const Isosurface* isosurface;  ///< none: the c-vertices are all that is known
};

/// Finds, for the c-vertices of some cells, the closest points of the mesh: out[i] belongs to the i-th c-vertex of the cells
/// taken one after the other. Parallel over cells.
void find_closest(const MeasuredSurface& surface, const LevelMesh& mesh, std::span<const CellId> cells, std::vector<ClosestPoint>& out);

/// Points of the surface between c-vertices, about one per face: where the surface bulges most from what c-vertices say of it.
/// Found when first asked for.
class BetweenPoints {
 public:
  BetweenPoints(const SurfaceComplex& complex, const Isosurface& isosurface);

  /// Calls visit(point), spacing applied, for every face whose first corner is `v`. Calls for different c-vertices may overlap.
  template <class Visit>
  void for_each_at(CVertexId v, Visit visit) const {
    for (const std::uint32_t face : faces_of_.of(v)) visit(point(face));
  }

 private:
  Vec3 point(std::uint32_t face) const;

  const SurfaceComplex& complex_;
  const Isosurface& isosurface_;
  Buckets faces_of_;  // per c-vertex, the faces with their first corner there
  mutable std::vector<Vec3> points_;
  mutable std::vector<std::uint8_t> known_;
};

/// Largest distance from the points between the c-vertices of some cells to the mesh, per cell of `cells`. Parallel over cells.
std::vector<float> measure_between(const BetweenPoints& between, const LevelMesh& mesh, std::span<const CellId> cells);

/// Distances from samples of the triangles of some cells to the surface: for each of these cells the largest, at samples that
/// are nearest to a c-vertex of the cell. Other cells' entries stay. Parallel over triangles.
///
/// @param look_closer  samples with a c-vertex within this distance are judged by its tangent plane, for others the closest point
///                     of the isosurface is looked for
void measure_from_mesh(const MeasuredSurface& surface, const LevelMesh& mesh, std::span<const CellId> cell_of,
                       std::span<const CellId> cells, double look_closer, std::vector<float>& from_mesh);

}  // namespace isoatlas
