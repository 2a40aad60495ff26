// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/float32.h"
#include "core/vector_math.h"
#include "geometry/bounds.h"

namespace isoatlas::detail {

/// The point relative to which float32 coordinates keep most digits: the centre of the box if the
/// box is farther from the origin than it is long, otherwise the origin. Its coordinates are
/// float32 values, so that viewers that compute in float32 add the same numbers.
inline Vec3 float32_origin_of(const Bounds& box) {
  const Vec3 middle = 0.5 * box.low + 0.5 * box.high;
  const double distance = std::max({std::fabs(middle.x), std::fabs(middle.y), std::fabs(middle.z)});
  if (distance <= box.longest() || !(distance < std::numeric_limits<float>::max())) return {};
  return {to_float32(middle.x), to_float32(middle.y), to_float32(middle.z)};
}

}  // namespace isoatlas::detail
