// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "embedding/subdivide.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// The multi-sheet grid cells: those with several surfels. In a grid cell with one surfel the
/// surface is a cone over a closed curve on the walls, which cannot intersect itself wherever in
/// the grid cell the c-vertex is; but two cones in one grid cell may intersect each other.
class MultiSheetCells {
 public:
  MultiSheetCells() = default;
  /// @pre  the complex is as it was parsed
  /// @cost O(F)
  MultiSheetCells(const SurfaceComplex& complex, const InterpolatedField& field,
                  const RunControl& control = {});

  /// Moves c-vertices of multi-sheet grid cells until no surfels intersect: then all faces of a
  /// complex that was subdivided everywhere are embedded.
  /// @return number of grid cells whose surfels still intersect
  /// @cost   an exact test of every multi-sheet grid cell; parallel
  std::size_t separate(SurfaceComplex& complex, const RunControl& control = {});

  /// per c-vertex, 1 if it is in a multi-sheet grid cell; empty: there are none
  std::span<const std::uint8_t> flags() const { return flags_; }
  bool contains(CVertexId v) const { return v < grid_cell_of_.size() && grid_cell_of_[v] != kNone; }

  /// All c-vertices in the grid cell of v. @pre contains(v)
  std::span<const CVertexId> c_vertices_in_cell_of(CVertexId v) const {
    return c_vertices(grid_cell_of_[v]);
  }

  /// Of the grid cells that contain one of `moved`: the c-vertices of those whose surfels intersect
  /// at these positions.
  /// @param positions  per c-vertex
  std::vector<CVertexId> intersecting(std::span<const CVertexId> moved,
                                      std::span<const Vec3> positions,
                                      const RunControl& control = {}) const;

 private:
  std::span<const CVertexId> c_vertices(std::uint32_t cell) const {
    return {c_vertices_.data() + first_[cell], c_vertices_.data() + first_[cell + 1]};
  }
  std::span<const Triangle> pieces(std::uint32_t cell) const {
    return {pieces_.data() + first_piece_[cell], pieces_.data() + first_piece_[cell + 1]};
  }
  std::span<const Vec3> wall_positions(std::uint32_t cell) const {
    return {wall_positions_.data() + first_wall_position_[cell],
            wall_positions_.data() + first_wall_position_[cell + 1]};
  }
  class Surfels;
  bool search_positions(std::uint32_t cell, std::span<Vec3> positions,
                        const RunControl& control) const;
  bool surfels_intersect(std::uint32_t cell, std::span<const Vec3> positions) const;
  std::vector<Vec3> centres(std::uint32_t cell) const;

  std::vector<std::uint8_t> flags_;          // per c-vertex
  std::vector<std::uint32_t> grid_cell_of_;  // per c-vertex, its multi-sheet grid cell or kNone
  std::vector<CVertexId> c_vertices_;        // cell by cell
  std::vector<std::uint32_t> first_;         // per cell, in c_vertices_
  std::vector<std::uint32_t> first_piece_;   // per cell, in pieces_
  std::vector<Triangle>
      pieces_;  // corners: first the c-vertices of the grid cell, then its points, counted from 0
  std::vector<std::uint32_t> first_wall_position_;  // per cell, in wall_positions_
  std::vector<Vec3> wall_positions_;  // nodes and the points between them; a point on a wall is
                                      // stored for both grid cells
};

}  // namespace isoatlas::detail
