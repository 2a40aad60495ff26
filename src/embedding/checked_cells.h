// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "complex/surface_complex.h"
#include "embedding/grid_cell.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// The checked grid cells. The surface in such a grid cell is more than one cone over a simple
/// curve. Its triangles may therefore intersect, depending on the positions of the c-vertices
/// inside the grid cell and on its walls. They are compared pair by pair after each displacement.
class CheckedCells {
 public:
  CheckedCells() = default;
  /// @param grid_cells  sorted, without duplicates; all faces around c-vertices inside them must
  ///                    be triangles
  /// @cost  O(F log grid cells)
  CheckedCells(const SurfaceComplex& complex, std::span<const GridCell> grid_cells,
               const RunControl& control = {});

  /// Whether v is inside a checked grid cell or on its walls.
  bool contains(CVertexId v) const {
    return v < complex_size_ && first_grid_cell_[v] != first_grid_cell_[v + 1];
  }

  /// Tests the checked grid cells that contain one of `moved`. Returns all c-vertices of the grid
  /// cells in which triangles intersect; some c-vertices may be listed several times.
  /// @param positions  the positions to test, per c-vertex
  /// @cost  an exact test of these grid cells; parallel
  std::vector<CVertexId> intersecting(std::span<const CVertexId> moved,
                                      std::span<const Vec3> positions,
                                      const RunControl& control = {}) const;

 private:
  std::span<const Triangle> triangles(std::uint32_t grid_cell) const {
    return {triangles_.data() + first_[grid_cell], triangles_.data() + first_[grid_cell + 1]};
  }

  std::uint32_t complex_size_ = 0;
  std::vector<std::uint32_t> first_;  // per grid cell, its first triangle in triangles_
  std::vector<Triangle>
      triangles_;  // sorted by grid cell; a triangle in two grid cells is stored twice
  std::vector<std::uint32_t> first_grid_cell_;  // per c-vertex, its first entry in grid_cells_of_
  std::vector<std::uint32_t> grid_cells_of_;    // may list a grid cell several times
};

}  // namespace isoatlas::detail
