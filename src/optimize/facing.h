// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/vector_math.h"

namespace isoatlas::detail {

/// Which way a triangle faces, by its area. Of a sliver that says nothing: there, all those around it.
/// @param corners  corners(t): the three of a triangle
/// @param for_each_around  called with a callable add(t), for every corner with all triangles there
template <class Corners, class ForEachAround>
Vec3 facing(std::uint32_t triangle, Corners corners, ForEachAround for_each_around) {
  constexpr double kSliver = 0.1;  // height over the longest edge
  const auto area = [&](std::uint32_t t) {
    const std::array<Vec3, 3> q = corners(t);
    return cross(q[1] - q[0], q[2] - q[0]);
  };
  const std::array<Vec3, 3> q = corners(triangle);
  const double longest = std::max({squared_length(q[1] - q[0]), squared_length(q[2] - q[1]), squared_length(q[0] - q[2])});
  const Vec3 own = area(triangle);
  if (length(own) >= kSliver * longest) return own;
  Vec3 sum;
  for_each_around([&](std::uint32_t t) { sum = sum + area(t); });
  return sum;
}

}  // namespace isoatlas::detail
