// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "field/field.h"
#include "isoatlas/mesh.h"
#include "isosurface/cell_loops.h"

namespace isoatlas::detail {

// Positions of points of the surface in a grid cell, whose corners are (0, 0, 0) to (1, 1, 1).
// These functions move points and never change the topology.

/// The samples at a cell's corners minus the isovalue, and those around the cell for cubic
/// interpolation.
struct CellValues {
  std::array<double, 8> corner;
  std::optional<TricubicCell> cubic;
};

/// Where the surface crosses an edge of the cell; never exactly at its ends.
Vec3 node_in_cell(const CellValues& cell, int edge);

/// The edges at whose nodes an annulus is cut, as bits.
unsigned cut_edges(const CellLoops& loops);

/// Moves a point away from the walls of the cell by a small margin.
Vec3 clamp_off_walls(Vec3 p);

/// Moves a point onto the isosurface by two Newton steps along the gradient; it stays in the cell
/// and gets no farther from the isosurface.
/// @param spacing  of the cell's sides
Vec3 onto_surface(const CellValues& cell, Vec3 start, Vec3 spacing);

}  // namespace isoatlas::detail
