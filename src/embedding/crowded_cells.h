// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "embedding/subdivide.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// The grid cells with several surfels. A cell with one surfel has a cone over a closed curve on the cell's walls, which cannot meet
/// itself wherever in the cell the c-vertex is; but two cones in one cell may meet each other.
class CrowdedCells {
 public:
  CrowdedCells() = default;
  /// @pre  the complex is as it was parsed
  /// @cost O(F)
  CrowdedCells(const SurfaceComplex& complex, const InterpolatedField& field, const RunControl& control = {});

  /// Moves c-vertices of crowded cells until no surfels meet: then all faces of a complex that was subdivided everywhere are embedded.
  /// @return how many cells have surfels that meet, wherever their c-vertices are put
  /// @cost   an exact look at every crowded cell; parallel
  std::size_t separate(SurfaceComplex& complex, const RunControl& control = {});

  std::span<const std::uint8_t> flags() const { return flags_; }  ///< per c-vertex, 1 if it is in such a cell; empty: none is
  bool contains(CVertexId v) const { return v < cell_of_.size() && cell_of_[v] != kNone; }

  /// All c-vertices in the grid cell of one. @pre contains(v)
  std::span<const CVertexId> beside(CVertexId v) const { return c_vertices(cell_of_[v]); }

  /// The c-vertices of those cells, with one of `moved` in them, whose surfels meet where the c-vertices are now.
  /// @param positions  per c-vertex
  std::vector<CVertexId> meeting(std::span<const CVertexId> moved, std::span<const Vec3> positions, const RunControl& control = {}) const;

 private:
  std::span<const CVertexId> c_vertices(std::uint32_t cell) const {
    return {c_vertices_.data() + first_[cell], c_vertices_.data() + first_[cell + 1]};
  }
  std::span<const Triangle> pieces(std::uint32_t cell) const {
    return {pieces_.data() + first_piece_[cell], pieces_.data() + first_piece_[cell + 1]};
  }
  std::span<const Vec3> points(std::uint32_t cell) const {
    return {points_.data() + first_point_[cell], points_.data() + first_point_[cell + 1]};
  }
  class Surfels;
  bool search_places(std::uint32_t cell, std::span<Vec3> places, const RunControl& control) const;
  bool surfels_meet(std::uint32_t cell, std::span<const Vec3> positions) const;
  std::vector<Vec3> middles(std::uint32_t cell) const;

  std::vector<std::uint8_t> flags_;         // per c-vertex
  std::vector<std::uint32_t> cell_of_;      // per c-vertex, its crowded cell; kNone
  std::vector<CVertexId> c_vertices_;       // cell by cell
  std::vector<std::uint32_t> first_;        // per cell, in c_vertices_
  std::vector<std::uint32_t> first_piece_;  // per cell, in pieces_
  std::vector<Triangle> pieces_;            // corners: first the cell's c-vertices, then its points, counted from 0
  std::vector<std::uint32_t> first_point_;  // per cell, in points_
  std::vector<Vec3> points_;                // nodes, and the points between them; one on a wall is there for both cells
};

}  // namespace isoatlas::detail
