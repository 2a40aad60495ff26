// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/vector_math.h"
#include "isoatlas/volume.h"

namespace isoatlas {

double Grid::smallest_spacing() const { return std::min({spacing.x, spacing.y, spacing.z}); }

bool Grid::mirrored() const { return dot(direction[0], cross(direction[1], direction[2])) < 0; }

Vec3 Grid::to_world(Vec3 index) const {
  const Vec3 s = scaled(index, spacing);
  return origin + (s.x * direction[0] + s.y * direction[1] + s.z * direction[2]);
}

}  // namespace isoatlas
