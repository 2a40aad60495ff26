// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/vector_math.h"
#include "field/to_space.h"
#include "isoatlas/volume.h"

namespace isoatlas {
using namespace detail;

double Grid::smallest_spacing() const { return std::min({spacing.x, spacing.y, spacing.z}); }

bool Grid::mirrored() const { return dot(direction[0], cross(direction[1], direction[2])) < 0; }

Vec3 Grid::to_world(Vec3 index) const {
  const Vec3 s = to_metric(index, spacing);
  return origin + (s.x * direction[0] + s.y * direction[1] + s.z * direction[2]);
}

Vec3 Grid::to_index(Vec3 world) const {
  // Cramer's rule.
  const Vec3 w = world - origin;
  const auto& [x, y, z] = direction;
  const double determinant = dot(x, cross(y, z));
  return {dot(w, cross(y, z)) / (determinant * spacing.x),
          dot(w, cross(z, x)) / (determinant * spacing.y),
          dot(w, cross(x, y)) / (determinant * spacing.z)};
}

}  // namespace isoatlas

namespace isoatlas::detail {

Vec3 to_space(const Grid& grid, Space space, Vec3 index) {
  if (space == Space::voxel) return index;
  const double flip = space == Space::ras ? -1 : 1;
  const Vec3 w = grid.to_world(index);
  return {flip * w.x, flip * w.y, w.z};
}

Vec3 from_space(const Grid& grid, Space space, Vec3 position) {
  if (space == Space::voxel) return position;
  const double flip = space == Space::ras ? -1 : 1;
  return grid.to_index({flip * position.x, flip * position.y, position.z});
}

}  // namespace isoatlas::detail
