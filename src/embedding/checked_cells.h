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

/// Grid cells that contain more than one cone over a simple curve, as pieces. Pieces there may
/// intersect, depending on where the c-vertices are inside the grid cell or on its walls, so they
/// are compared pair by pair after each move.
class CheckedCells {
 public:
  CheckedCells() = default;
  /// @param cells  sorted, each once; all faces around c-vertices inside them are triangles
  /// @cost  O(F log cells)
  CheckedCells(const SurfaceComplex& complex, std::span<const GridCell> cells,
               const RunControl& control = {});

  /// Whether v is in a checked grid cell or on its walls.
  bool contains(CVertexId v) const {
    return v < complex_size_ && first_cell_[v] != first_cell_[v + 1];
  }

  /// Of the checked grid cells that contain one of `moved`: all c-vertices of those in which
  /// triangles intersect at these positions; some may be listed several times.
  /// @param positions  per c-vertex
  /// @cost  an exact test of these grid cells; parallel
  std::vector<CVertexId> intersecting(std::span<const CVertexId> moved,
                                      std::span<const Vec3> positions,
                                      const RunControl& control = {}) const;

 private:
  std::span<const Triangle> triangles(std::uint32_t cell) const {
    return {triangles_.data() + first_[cell], triangles_.data() + first_[cell + 1]};
  }

  std::uint32_t complex_size_ = 0;
  std::vector<std::uint32_t> first_;  // per cell, in triangles_
  std::vector<Triangle> triangles_;   // cell by cell; a triangle in two grid cells is stored twice
  std::vector<std::uint32_t> first_cell_;     // per c-vertex, in grid_cells_of_
  std::vector<std::uint32_t> grid_cells_of_;  // may list a grid cell several times
};

}  // namespace isoatlas::detail
