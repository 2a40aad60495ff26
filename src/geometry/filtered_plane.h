// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "core/vector_math.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail {

// Whether products below neither underflow nor overflow.
inline bool is_moderate(double x) { return x > 1e-60 && x < 1e60; }

// Determines on which side of the plane of three points a point lies, where doubles suffice: by one
// normal and a height with an error bound. The six products of a height are each below u v w, the
// largest coordinates of three differences, and each has a relative error below 8 times 2^-53, so
// 48 * 2^-53 * u v w bounds the error; kError is twice that. If coordinates may move by a slack,
// the coordinates of differences move by twice that, e, and the height by up to 6 ((u + e) (v + e)
// (w + e) - u v w).
class FilteredPlane {
 public:
  FilteredPlane() = default;  ///< every side is unknown
  FilteredPlane(Vec3 p, Vec3 q, Vec3 r, double slack = 0) : apex_(p) {
    const Vec3 along = q - p, across = r - p;
    const double u = largest_coordinate(along), v = largest_coordinate(across);
    if (!is_moderate(u) || !is_moderate(v)) return;
    normal_ = cross(along, across);
    const double e = 2 * slack, moved = (u + e) * (v + e);
    relative_error_ = kError * u * v + 6 * (moved - u * v);
    constant_error_ = 6 * moved * e;
  }
  FilteredPlane(std::span<const Vec3> positions, const Triangle& t, double slack = 0)
      : FilteredPlane(positions[t[0]], positions[t[1]], positions[t[2]], slack) {}

  /// 1: certainly above, -1: certainly below, 0: unknown.
  int side(Vec3 p) const {
    const Vec3 to = p - apex_;
    const double w = largest_coordinate(to), height = dot(normal_, to);
    if (!is_moderate(w) || !(std::fabs(height) > relative_error_ * w + constant_error_)) return 0;
    return height > 0 ? 1 : -1;
  }

 private:
  static constexpr double kError = 1.1e-14;

  Vec3 apex_, normal_;
  double relative_error_ = 0;  // factor of the largest coordinate of the difference; if the normal
                               // is 0, no height exceeds it
  double constant_error_ = 0;  // independent of the difference
};

}  // namespace isoatlas::detail
