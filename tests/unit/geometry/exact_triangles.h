// SPDX-License-Identifier: Apache-2.0
// A slow reference for triangles with whole-number corners: every corner of the intersection as a
// fraction of integers.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isoatlas/mesh.h"

namespace isoatlas::detail::test {

using LatticePoint =
    std::array<std::int64_t, 3>;  // coordinates of at most 20, so that nothing below overflows

std::vector<Vec3> to_positions(const std::vector<LatticePoint>& points, double scale = 1,
                               Vec3 offset = {});

/// The definition of intersect_beyond_shared_simplex(), applied directly: an intersection of two
/// convex sets is contained in a third if its corners are.
bool slow_intersect_beyond_shared_simplex(const std::vector<LatticePoint>& points,
                                          const Triangle& a, const Triangle& b);

}  // namespace isoatlas::detail::test
