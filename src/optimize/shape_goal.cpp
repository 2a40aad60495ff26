// SPDX-License-Identifier: Apache-2.0
#include "optimize/shape_goal.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/vector_math.h"

namespace isoatlas::detail {

ShapeGoal ShapeGoal::of(double aspect) {
  const ShapeGoal standard;
  return {aspect, standard.sine * std::min(1.0, aspect / standard.aspect)};
}

double ShapeGoal::score(Vec3 a, Vec3 b, Vec3 c) const {
  std::array<double, 3> squared{squared_length(b - a), squared_length(c - b),
                                squared_length(a - c)};
  std::sort(squared.begin(), squared.end());
  if (!(squared[0] > 0)) return 0;
  const double ratio = std::sqrt(squared[0] / squared[2]);
  const double smallest = length(cross(b - a, c - a)) / std::sqrt(squared[1] * squared[2]);
  return std::min(ratio / aspect, smallest / sine);
}

}  // namespace isoatlas::detail
