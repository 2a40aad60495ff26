// SPDX-License-Identifier: Apache-2.0
#include "error/area_samples.h"

#include <algorithm>
#include <utility>

#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

constexpr int kHalvings = 18;  // of a triangle: a patch is 2^-18 of its area

}  // namespace

AreaSamples::AreaSamples(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                         std::size_t count)
    : positions_(positions), triangles_(triangles), samples_(count) {
  const auto n = static_cast<std::uint32_t>(triangles.size());
  std::vector<double> cumulative(n);  // cumulative area, including this triangle
  for (std::uint32_t t = 0; t < n; ++t) {
    const auto [a, b, c] = triangles[t];
    area_ += 0.5 * length(cross(positions[b] - positions[a], positions[c] - positions[a]));
    cumulative[t] = area_;
  }
  double whole = area_;
  if (!(whole > 0)) {
    whole = n;
    for (std::uint32_t t = 0; t < n; ++t) cumulative[t] = t + 1;
  }
  std::uint32_t t = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(count) * whole;
    while (t + 1 < n && cumulative[t] < at) ++t;
    const double before = t == 0 ? 0 : cumulative[t - 1];
    samples_[i] = {
        t, static_cast<float>(std::clamp((at - before) / (cumulative[t] - before), 0.0, 1.0))};
  }
}

Vec3 AreaSamples::point(std::size_t i) const {
  // The curve through a triangle goes from one end of its longest side to the other. Bisected
  // there, it consists of two curves through two triangles of half the area, which share the third
  // corner, and so on recursively.
  const Triangle& corners = triangles_[samples_[i].triangle];
  Vec3 from = positions_[corners[0]], apex = positions_[corners[1]], to = positions_[corners[2]];
  const double sides[3] = {squared_length(to - from), squared_length(apex - from),
                           squared_length(to - apex)};
  if (sides[1] > sides[0] && sides[1] >= sides[2]) {
    std::swap(apex, to);
  } else if (sides[2] > sides[0]) {
    std::swap(apex, from);
  }
  float curve_share = samples_[i].curve_share;
  for (int k = 0; k < kHalvings; ++k) {
    const Vec3 middle = 0.5 * (from + to);
    curve_share *= 2;
    if (curve_share < 1) {
      to = apex;
    } else {
      from = apex;
      curve_share -= 1;
    }
    apex = middle;
  }
  return (1.0 / 3) * (from + apex + to);
}

}  // namespace isoatlas::detail
