// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isoatlas/self_intersections.h"

namespace isoatlas {

/// The corners of all triangles that meet others where they should not, sorted. @cost as self_intersections()
std::vector<std::uint32_t> meeting_corners(std::span<const Vec3> positions, std::span<const Triangle> triangles, const RunControl& control);

}  // namespace isoatlas
