// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "isoatlas/volume.h"

namespace isoatlas::detail {

inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
inline Vec3 scaled(Vec3 a, Vec3 s) { return {a.x * s.x, a.y * s.y, a.z * s.z}; }

/// Conversion between sample-index coordinates and the metric, by a factor per axis. In
/// src/complex, embedding, error, optimize and levels `position` names a point in sample-index
/// coordinates, `point` one in the metric (lengths in smallest spacings) and `output_position` one
/// in the space that is written. Fields and the isosurface take and return sample-index
/// coordinates.
inline Vec3 to_metric(Vec3 position, Vec3 spacing) { return scaled(position, spacing); }
inline Vec3 to_index(Vec3 point, Vec3 spacing) {
  return {point.x / spacing.x, point.y / spacing.y, point.z / spacing.z};
}

inline double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double squared_length(Vec3 a) { return dot(a, a); }
inline double length(Vec3 a) { return std::sqrt(dot(a, a)); }
/// The largest absolute value of a coordinate.
inline double largest_coordinate(Vec3 v) {
  return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

/// The vector divided by its length, also where squares would overflow or underflow; zero stays
/// zero.
inline Vec3 normalized(Vec3 a) {
  const double largest = std::fmax(std::fabs(a.x), std::fmax(std::fabs(a.y), std::fabs(a.z)));
  if (!(largest > 0) || !std::isfinite(largest)) return {};
  const Vec3 b{a.x / largest, a.y / largest, a.z / largest};
  return (1 / length(b)) * b;
}

/// Squared metric distance of two points in sample-index coordinates.
inline double squared_distance(Vec3 a, Vec3 b, Vec3 spacing) {
  return squared_length(scaled(a - b, spacing));
}

}  // namespace isoatlas::detail
