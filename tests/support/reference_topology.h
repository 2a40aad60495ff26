// SPDX-License-Identifier: Apache-2.0
// A slow reference for the topology of an isosurface, sharing nothing with src/.
#pragma once

#include "isoatlas/extract.h"
#include "support/volumes.h"

namespace isoatlas::detail::test {

/// Counts the cell complex itself, not its dual: a vertex on every grid edge with a sign change, an
/// edge for every segment on a grid face, a disk for every loop of segments in a cell. Plain maps,
/// exact integers.
///
/// @param isovalue a whole or a half number
TopologySummary reference_topology(const Samples& samples, double isovalue,
                                   Inside inside = Inside::above);

/// Is there a sample on either side?
bool has_surface(const Samples& samples, double isovalue, Inside inside = Inside::above);

}  // namespace isoatlas::detail::test
