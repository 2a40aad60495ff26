// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>

#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// The smallest axis-aligned box that contains some points.
struct Bounds {
  Vec3 low, high;
  double longest() const { return std::max({high.x - low.x, high.y - low.y, high.z - low.z}); }
};

/// O(n). @pre there are points
inline Bounds bounds_of(std::span<const Vec3> points) {
  Bounds out{points.front(), points.front()};
  for (const Vec3& p : points) {
    out.low = {std::min(out.low.x, p.x), std::min(out.low.y, p.y), std::min(out.low.z, p.z)};
    out.high = {std::max(out.high.x, p.x), std::max(out.high.y, p.y), std::max(out.high.z, p.z)};
  }
  return out;
}

}  // namespace isoatlas::detail
