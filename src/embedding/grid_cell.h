// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

#include "core/vector_math.h"

namespace isoatlas::detail {

/// A grid cell, named by its lowest corner in sample-index coordinates.
using GridCell = std::array<double, 3>;

/// The grid cell that contains a position; of a position on a wall, the higher one.
inline GridCell grid_cell_of(Vec3 position) {
  return {std::floor(position.x), std::floor(position.y), std::floor(position.z)};
}

}  // namespace isoatlas::detail
