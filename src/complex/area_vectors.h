// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "complex/surface_complex.h"

namespace isoatlas::detail {

/// For each group of c-vertices, the sum over its c-vertices of the area vectors of the faces
/// there. It points from inside to outside; metric. O(F).
/// @param group_of per c-vertex, < groups
std::vector<Vec3> area_vectors(const SurfaceComplex& complex,
                               std::span<const std::uint32_t> group_of, std::uint32_t groups);

}  // namespace isoatlas::detail
