// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "isoatlas/volume.h"

namespace isoatlas::detail {

constexpr double coordinate(const Vec3& p, int axis) {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

/// The faces of the box around all samples of a volume, in sample-index coordinates. Face 2 * a + s
/// is normal to axis a and contains the first (s = 0) or the last (s = 1) samples along a.
struct BoxFaces {
  Vec3 high{};  ///< position of the last sample; that of the first is (0, 0, 0)

  /// Bit per face that contains a point of the box.
  unsigned containing(const Vec3& p) const {
    unsigned out = 0;
    for (int a = 0; a < 3; ++a) {
      if (coordinate(p, a) == 0) out |= 1u << (2 * a);
      if (coordinate(p, a) == coordinate(high, a)) out |= 2u << (2 * a);
    }
    return out;
  }
  /// Corner k is at the last sample along axis a if bit a of k is set.
  Vec3 corner(unsigned k) const {
    return {(k & 1) != 0 ? high.x : 0, (k & 2) != 0 ? high.y : 0, (k & 4) != 0 ? high.z : 0};
  }
};

/// Faces of a box: per axis, the one at the first sample and the one at the last.
using SharedFaces = std::array<std::array<bool, 2>, 3>;

/// Bit 2 * a + s is set for face s of axis a, as in BoxFaces::containing().
constexpr unsigned bits_of(const SharedFaces& faces) {
  unsigned out = 0;
  for (unsigned a = 0; a < 3; ++a)
    for (unsigned s = 0; s < 2; ++s) out |= faces[a][s] ? 1u << (2 * a + s) : 0;
  return out;
}

/// The faces of a block that it shares with other blocks.
struct SharedBox {
  BoxFaces box;
  unsigned faces = 0;  ///< see bits_of()

  unsigned containing(const Vec3& p) const { return box.containing(p) & faces; }
};

}  // namespace isoatlas::detail
