// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// What counts as a badly shaped triangle.
struct ShapeGoal {
  double aspect = 1.0 / 3;            ///< shortest over longest edge, at least
  double sine = 0.30901699437494742;  ///< of the smallest angle, at least; of 18 degrees: (sqrt(5) - 1) / 4

  /// The sine becomes smaller with an aspect ratio below 1/3.
  static ShapeGoal of(double aspect);
  /// 1 where both are just met, less where one is not.
  double score(Vec3 a, Vec3 b, Vec3 c) const;
};

}  // namespace isoatlas::detail
