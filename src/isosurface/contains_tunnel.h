// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "core/exact_numbers.h"
#include "isosurface/cell_loops.h"

namespace isoatlas::detail {

/// Whether the trilinear interpolant of a cell has this tunnel. Decided exactly; equality counts as
/// inside.
///
/// @param samples  of the corners, inside iff >= isovalue; any finite doubles or 64-bit integers
/// @param tunnel   from CellLoopTable::tunnels() for the cell's corners and the exact decisions on
///                 its faces
/// @cost  a floating-point filter nearly always suffices; otherwise integers as long as necessary
bool contains_tunnel(const Tunnel& tunnel, const std::array<ExactSample, 8>& samples,
                     const ExactSample& isovalue);

}  // namespace isoatlas::detail
