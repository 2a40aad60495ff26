// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "error/error_field.h"
#include "error/level_mesh.h"

namespace isoatlas::detail {

/// The c-vertices of each grid cell. A c-vertex on a wall is in the grid cells on both sides. 12
/// bytes per c-vertex.
class GridCellIndex {
 public:
  using Key = std::uint64_t;

  /// @param last  index of the volume's last sample
  GridCellIndex(const SurfaceComplex& complex, Vec3 last, const RunControl* control = nullptr);

  /// Calls visit(key) for the grid cells that contain a c-vertex.
  template <class Visit>
  void for_each_at(CVertexId v, Visit visit) const {
    visit_cells(complex_.positions[v], visit);
  }
  std::span<const CVertexId> c_vertices(Key cell) const;
  std::vector<Key> cells() const;  ///< those with a c-vertex, sorted
  /// The corner of a grid cell with the smallest index.
  Vec3 low(Key cell) const;

 private:
  template <class Visit>
  void visit_cells(Vec3 p, Visit visit) const;

  const SurfaceComplex& complex_;
  Key size_x_, size_y_, size_z_;  // number of grid cells along each axis
  std::vector<Key> keys_;         // sorted
  std::vector<CVertexId> items_;
};

/// Proves for some Voronoi cells that the isosurface in their grid cells is no farther than `bound`
/// from the mesh.
///
/// Inside a box in a grid cell the trilinear isosurface lies between two parallel planes, since the
/// difference of the field from a linear function is largest at the corners. The distance to a
/// triangle is convex, so it is largest at a corner of the part of the box between the planes.
/// Boxes that are not proved to be near one triangle are bisected, down to a sixteenth of a grid
/// cell.
///
/// @return per cell of `cells`, the distance that could not be excluded and a c-vertex of the cell
///         near there; kNone if the bound is proved. Nothing is proved where the field is not
///         trilinear. Parallel over cells
/// @cost   about 2 microseconds per grid cell
std::vector<Farthest> prove_surface_near(const MeasuredSurface& surface,
                                         const GridCellIndex& grid_cell_index,
                                         const LevelMesh& mesh, std::span<const CellId> cell_of,
                                         std::span<const CellId> cells, double bound);

}  // namespace isoatlas::detail
