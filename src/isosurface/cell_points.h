// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "field/field.h"
#include "isoatlas/mesh.h"
#include "isosurface/cell_loops.h"

namespace isoatlas::detail {

// Where points of the surface are in a grid cell, whose corners are (0, 0, 0) to (1, 1, 1). Moves points, never topology.

/// What places points in a cell: the samples at its corners less the isovalue, and those around it where the interpolation is cubic.
struct CellValues {
  std::array<double, 8> corner;
  std::optional<TricubicCell> cubic;
};

/// Where the surface crosses an edge of the cell, never quite at its ends.
Vec3 node_in_cell(const CellValues& cell, int edge);

/// The edges at whose nodes an annulus is cut, one bit each.
unsigned cut_edges(const CellLoops& loops);

/// Not on a wall of the cell, nor very near to one.
Vec3 off_the_walls(Vec3 p);

/// Two Newton steps along the gradient onto the isosurface, never out of the cell, never farther from it.
/// @param spacing  of the cell's sides
Vec3 onto_surface(const CellValues& cell, Vec3 start, Vec3 spacing);

}  // namespace isoatlas::detail
