// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "complex/surface_complex.h"
#include "embedding/grid_cell.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// A point of some pieces and where it is if they are flat.
struct FreePoint {
  CVertexId at;
  Vec3 flat;
};

/// A triangle in a grid cell.
struct Piece {
  GridCell grid_cell;
  Triangle corners;
};

/// Moves free points from the surface towards their flat positions wherever pieces in one grid cell
/// intersect: by half the way, by half the rest, then onto them. With all points at their flat
/// positions no pieces intersect; otherwise some may be left.
///
/// @param free       sorted by c-vertex
/// @param pieces     all in the grid cells of the free points, in any order; sorted here
/// @param positions  per c-vertex
/// @cost  O(n log n), plus the squared number of pieces in each grid cell
void separate_pieces(std::span<const FreePoint> free, std::vector<Piece> pieces,
                     std::span<Vec3> positions, const RunControl& control);

}  // namespace isoatlas::detail
