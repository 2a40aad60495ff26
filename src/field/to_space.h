// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// A position in sample indices as a position in `space`. Every caller gets the same bits.
Vec3 to_space(const Grid& grid, Space space, Vec3 index);

}  // namespace isoatlas::detail
