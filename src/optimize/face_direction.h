// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/vector_math.h"

namespace isoatlas::detail {

/// The direction of a triangle's front side: its area vector. The area vector of a sliver is
/// unreliable; for a sliver this is the sum over all triangles around it.
/// @param corners  returns the three corners of a triangle t: corners(t)
/// @param for_each_neighbour  is called with a callable add(t); must call add(t) for all triangles
///                            at each corner
template <class Corners, class ForEachNeighbour>
Vec3 face_direction(std::uint32_t triangle, Corners corners, ForEachNeighbour for_each_neighbour) {
  constexpr double kSliver = 0.1;  // height over the longest edge
  const auto area = [&](std::uint32_t t) {
    const std::array<Vec3, 3> q = corners(t);
    return cross(q[1] - q[0], q[2] - q[0]);
  };
  const std::array<Vec3, 3> q = corners(triangle);
  const double longest = std::max(
      {squared_length(q[1] - q[0]), squared_length(q[2] - q[1]), squared_length(q[0] - q[2])});
  const Vec3 own = area(triangle);
  if (length(own) >= kSliver * longest) return own;
  Vec3 sum;
  for_each_neighbour([&](std::uint32_t t) { sum = sum + area(t); });
  return sum;
}

}  // namespace isoatlas::detail
