// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "complex/surface_complex.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// Grid cells with more in them than one cone over a simple curve, in pieces: there it matters where in the cell, or on its walls, the
/// c-vertices are.
class WatchedCells {
 public:
  using Cell = std::array<double, 3>;  ///< its lowest corner

  WatchedCells() = default;
  /// @param cells  sorted, each once; around c-vertices inside them there are triangles only
  /// @cost  O(F log cells)
  WatchedCells(const SurfaceComplex& complex, std::span<const Cell> cells, const RunControl& control = {});

  /// In such a cell, or on its walls.
  bool contains(CVertexId v) const { return v < complex_size_ && first_cell_[v] != first_cell_[v + 1]; }

  /// All c-vertices of those cells, with one of `moved` in them, in which triangles meet where the c-vertices are now; some may be there
  /// several times.
  /// @param positions  per c-vertex
  /// @cost  an exact look at these cells; parallel
  std::vector<CVertexId> meeting(std::span<const CVertexId> moved, std::span<const Vec3> positions, const RunControl& control = {}) const;

 private:
  std::span<const Triangle> triangles(std::uint32_t cell) const {
    return {triangles_.data() + first_[cell], triangles_.data() + first_[cell + 1]};
  }

  std::uint32_t complex_size_ = 0;
  std::vector<std::uint32_t> first_;       // per cell, in triangles_
  std::vector<Triangle> triangles_;        // cell by cell; one that is in two cells is there twice
  std::vector<std::uint32_t> first_cell_;  // per c-vertex, in cells_of_
  std::vector<std::uint32_t> cells_of_;    // may hold one several times
};

}  // namespace isoatlas::detail
