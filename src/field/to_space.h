// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// Converts sample-index coordinates to `space`. Every caller gets the same bits.
Vec3 to_space(const Grid& grid, Space space, Vec3 index);

/// Converts a position in `space` to sample-index coordinates.
Vec3 from_space(const Grid& grid, Space space, Vec3 position);

}  // namespace isoatlas::detail
