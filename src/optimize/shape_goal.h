// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// The criterion for badly shaped triangles.
struct ShapeGoal {
  double aspect = 1.0 / 3;            ///< smallest ratio of shortest to longest edge
  double sine = 0.30901699437494742;  ///< smallest sine of the smallest angle; that of 18 degrees:
                                      ///< (sqrt(5) - 1) / 4

  /// The sine is lowered together with an aspect ratio below 1/3.
  static ShapeGoal of(double aspect);
  /// At least 1 if both criteria are satisfied, less if one is violated.
  double score(Vec3 a, Vec3 b, Vec3 c) const;
};

}  // namespace isoatlas::detail
