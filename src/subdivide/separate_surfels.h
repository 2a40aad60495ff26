// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subdivide/subdivide.h"

namespace isoatlas {

/// Moves the c-vertices of grid cells that have several, until the surfels there do not meet: a cell with one surfel has a cone over a
/// closed curve on the cell's walls, which cannot meet itself, but two cones in one cell may meet each other. Then all faces of a
/// complex that was subdivided everywhere are embedded.
///
/// @return how many cells have surfels that meet, wherever their c-vertices are put
/// @cost   O(F), plus an exact look at every cell with several surfels; parallel over these
std::size_t separate_surfels(SurfaceComplex& complex, const TrilinearField& field);

}  // namespace isoatlas
