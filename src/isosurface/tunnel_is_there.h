// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "isosurface/cell_loops.h"

namespace isoatlas::detail {

/// Is this tunnel in the trilinear interpolant of a cell? Decided exactly; equal is inside.
///
/// @param samples  of the corners, inside iff >= isovalue; any finite doubles or 64-bit integers
/// @param tunnel   of CellLoopTable::tunnels() for the cell's corners and the exact decisions on its faces
/// @cost  a floating-point filter decides nearly always; else integers as long as they need be
bool tunnel_is_there(const Tunnel& tunnel, const std::array<long double, 8>& samples, long double isovalue);

}  // namespace isoatlas::detail
