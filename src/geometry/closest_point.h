// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "core/vector_math.h"

namespace isoatlas::detail {

/// A point of a triangle, with weight[k] for corner k; weights are >= 0 and add up to 1, up to
/// rounding.
struct TrianglePoint {
  Vec3 point{};
  std::array<double, 3> weight{};
  double squared_distance = 0;  ///< from the query point
};

/// The point of segment ab closest to p, as a fraction of the way from a to b; 0 if the segment has
/// no length.
inline double closest_on_segment(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 ab = b - a;
  const double squared = squared_length(ab), along = dot(p - a, ab);
  return squared > 0 ? std::clamp(along / squared, 0.0, 1.0) : 0;
}

/// The point of triangle abc closest to p.
///
/// Triangles without area are treated as segments or points. The result is always a point of the
/// triangle and, up to rounding, never farther than the closest point of its sides: where a
/// triangle is so thin that rounding decides on which side of it p is, its inside and all three
/// sides are compared.
inline TrianglePoint closest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  constexpr double kThin = 1e-10;  // squared sine of the angle at a, below which a triangle is thin
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const Vec3 normal = cross(ab, ac);
  const double squared = squared_length(normal);
  const bool thin = !(squared > kThin * squared_length(ab) * squared_length(ac));
  const double wb = dot(cross(ap, ac), normal), wc = dot(cross(ab, ap), normal),
               wa = squared - wb - wc;
  TrianglePoint best;
  best.squared_distance = std::numeric_limits<double>::infinity();
  if (squared > 0 && wa >= 0 && wb >= 0 && wc >= 0) {
    best.weight = {wa / squared, wb / squared, wc / squared};
    best.point = a + (best.weight[1] * ab + best.weight[2] * ac);
    best.squared_distance = squared_length(p - best.point);
    if (!thin) return best;
  }
  // Outside, the closest point is on a side that p lies beyond.
  const auto side = [&](std::size_t i, std::size_t j, Vec3 from, Vec3 to) {
    const double t = closest_on_segment(p, from, to);
    const Vec3 q = from + t * (to - from);
    const double d = squared_length(p - q);
    if (!(d < best.squared_distance)) return;
    best = {q, {}, d};
    best.weight[i] = 1 - t;
    best.weight[j] = t;
  };
  if (wc < 0 || thin) side(0, 1, a, b);
  if (wa < 0 || thin) side(1, 2, b, c);
  if (wb < 0 || thin) side(2, 0, c, a);
  return best;
}

}  // namespace isoatlas::detail
