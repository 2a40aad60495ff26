// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "core/vector_math.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail {

inline double largest_coordinate(Vec3 v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

// True where the products below neither underflow nor overflow.
inline bool is_moderate(double x) { return x > 1e-60 && x < 1e60; }

// Tells on which side of the plane of three points a point lies, where doubles suffice: by one normal and a height whose error is bounded.
// The six products of a height are each below u v w, the largest coordinates of three differences, and each has a relative error below 8
// times 2^-53, so 48 * 2^-53 * u v w bounds the error; kError is twice that. If coordinates may move by a slack, the coordinates of
// differences move by twice that, e, and the height by up to 6 ((u + e) (v + e) (w + e) - u v w).
class RoughPlane {
 public:
  RoughPlane() = default;  ///< knows nothing
  RoughPlane(Vec3 p, Vec3 q, Vec3 r, double slack = 0) : apex_(p) {
    const Vec3 along = q - p, across = r - p;
    const double u = largest_coordinate(along), v = largest_coordinate(across);
    if (!is_moderate(u) || !is_moderate(v)) return;
    normal_ = cross(along, across);
    const double e = 2 * slack, moved = (u + e) * (v + e);
    error_ = kError * u * v + 6 * (moved - u * v);
    least_ = 6 * moved * e;
  }
  RoughPlane(std::span<const Vec3> positions, const Triangle& t, double slack = 0)
      : RoughPlane(positions[t[0]], positions[t[1]], positions[t[2]], slack) {}

  /// 1: above for sure, -1: below for sure; 0: not known.
  int side(Vec3 p) const {
    const Vec3 to = p - apex_;
    const double w = largest_coordinate(to), height = dot(normal_, to);
    if (!is_moderate(w) || !(std::fabs(height) > error_ * w + least_)) return 0;
    return height > 0 ? 1 : -1;
  }

 private:
  static constexpr double kError = 1.1e-14;

  Vec3 apex_, normal_;
  double error_ = 0;  // times the largest coordinate of the difference; with a normal of 0 no height is above it
  double least_ = 0;  // whatever the difference
};

}  // namespace isoatlas::detail
