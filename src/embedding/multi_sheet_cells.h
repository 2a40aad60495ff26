// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "embedding/subdivide.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// The multi-sheet grid cells: grid cells with several surfels. A surfel is a cone over a closed
/// curve on the walls. One cone never intersects itself, for any position of its c-vertex in the
/// grid cell, but two cones in one grid cell may intersect each other.
class MultiSheetCells {
 public:
  MultiSheetCells() = default;
  /// @pre  the complex is as it was parsed
  /// @cost O(F)
  MultiSheetCells(const SurfaceComplex& complex, const InterpolatedField& field,
                  const RunControl& control = {});

  /// Moves c-vertices of multi-sheet grid cells until no surfels intersect. The complex is then
  /// embedded if it is subdivided everywhere.
  /// @return number of grid cells whose surfels still intersect
  /// @cost   an exact test of every multi-sheet grid cell; parallel
  std::size_t separate(SurfaceComplex& complex, const RunControl& control = {});

  /// per c-vertex, 1 if it is in a multi-sheet grid cell; empty if no grid cell is multi-sheet
  std::span<const std::uint8_t> flags() const { return flags_; }
  bool contains(CVertexId v) const { return v < grid_cell_of_.size() && grid_cell_of_[v] != kNone; }

  /// All c-vertices in the grid cell of v. @pre contains(v)
  std::span<const CVertexId> c_vertices_in_grid_cell_of(CVertexId v) const {
    return c_vertices(grid_cell_of_[v]);
  }

  /// Tests the multi-sheet grid cells that contain one of `moved`. Returns the c-vertices of the
  /// grid cells whose surfels intersect.
  /// @param positions  the positions to test, per c-vertex
  std::vector<CVertexId> intersecting(std::span<const CVertexId> moved,
                                      std::span<const Vec3> positions,
                                      const RunControl& control = {}) const;

 private:
  std::span<const CVertexId> c_vertices(std::uint32_t grid_cell) const {
    return {c_vertices_.data() + first_[grid_cell], c_vertices_.data() + first_[grid_cell + 1]};
  }
  std::span<const Triangle> pieces(std::uint32_t grid_cell) const {
    return {pieces_.data() + first_piece_[grid_cell], pieces_.data() + first_piece_[grid_cell + 1]};
  }
  std::span<const Vec3> wall_positions(std::uint32_t grid_cell) const {
    return {wall_positions_.data() + first_wall_position_[grid_cell],
            wall_positions_.data() + first_wall_position_[grid_cell + 1]};
  }
  class Surfels;
  bool search_positions(std::uint32_t grid_cell, std::span<Vec3> positions,
                        const RunControl& control) const;
  bool surfels_intersect(std::uint32_t grid_cell, std::span<const Vec3> positions) const;
  std::vector<Vec3> centres(std::uint32_t grid_cell) const;

  std::vector<std::uint8_t> flags_;          // per c-vertex
  std::vector<std::uint32_t> grid_cell_of_;  // per c-vertex, its multi-sheet grid cell or kNone
  std::vector<CVertexId> c_vertices_;        // sorted by grid cell
  std::vector<std::uint32_t> first_;         // per grid cell, its first entry in c_vertices_
  std::vector<std::uint32_t> first_piece_;   // per grid cell, its first entry in pieces_
  std::vector<Triangle> pieces_;             // triangles of surfels. Their corners are indices,
                                             // from 0, into the c-vertices of the grid cell
                                             // followed by its wall positions
  std::vector<std::uint32_t>
      first_wall_position_;           // per grid cell, its first entry in wall_positions_
  std::vector<Vec3> wall_positions_;  // nodes and the points between them; a point on a wall is
                                      // stored once for each of its two grid cells
};

}  // namespace isoatlas::detail
