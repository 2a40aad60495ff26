// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>

#include "geometry/box_faces.h"
#include "isoatlas/blocks.h"

namespace isoatlas::detail {

/// The planes between the blocks, in sample-index coordinates of the whole volume.
class SharedPlanes {
 public:
  explicit SharedPlanes(const BlockPlan& plan) : plan_(plan) {}

  bool is_on_plane(const Vec3& p, int axis) const {
    const auto a = static_cast<std::size_t>(axis);
    const double x = coordinate(p, axis);
    return x > 0 && x < static_cast<double>(plan_.grid().size[a] - 1) &&
           std::fmod(x, static_cast<double>(plan_.block_size()[a])) == 0;
  }
  /// The number of blocks that contain a point: two per plane that it is on.
  std::size_t blocks_at(const Vec3& p) const {
    std::size_t out = 1;
    for (int axis = 0; axis < 3; ++axis) out *= is_on_plane(p, axis) ? 2 : 1;
    return out;
  }
  bool have_common_plane(const Vec3& p, const Vec3& q) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (coordinate(p, axis) == coordinate(q, axis) && is_on_plane(p, axis)) return true;
    }
    return false;
  }

 private:
  const BlockPlan& plan_;
};

}  // namespace isoatlas::detail
