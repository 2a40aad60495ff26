// SPDX-License-Identifier: Apache-2.0
#include "measure/area_samples.h"

#include <algorithm>
#include <utility>

#include "core/vector_math.h"

namespace isoatlas {
namespace {

constexpr int kHalvings = 18;  // of a triangle: patches of a quarter millionth of it

}  // namespace

AreaSamples::AreaSamples(const TriangleTree& tree, std::size_t count) : tree_(tree), samples_(count) {
  const std::uint32_t triangles = tree.triangle_count();
  std::vector<double> until(triangles);  // area up to and with this triangle
  for (std::uint32_t s = 0; s < triangles; ++s) {
    const auto [a, b, c] = tree.corners_in(s);
    const Vec3 p = tree.positions()[a];
    area_ += 0.5 * length(cross(tree.positions()[b] - p, tree.positions()[c] - p));
    until[s] = area_;
  }
  double whole = area_;
  if (!(whole > 0)) {
    whole = triangles;
    for (std::uint32_t s = 0; s < triangles; ++s) until[s] = s + 1;
  }
  std::uint32_t s = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(count) * whole;
    while (s + 1 < triangles && until[s] < at) ++s;
    const double before = s == 0 ? 0 : until[s - 1];
    samples_[i] = {s, static_cast<float>(std::clamp((at - before) / (until[s] - before), 0.0, 1.0))};
  }
}

Vec3 AreaSamples::point(std::size_t i) const {
  // The curve through a triangle goes from one end of its longest side to the other. Cut there, it is two curves through two
  // triangles of half the area, which meet at the third corner; and so on.
  const Triangle& corners = tree_.corners_in(samples_[i].slot);
  Vec3 from = tree_.positions()[corners[0]], apex = tree_.positions()[corners[1]], to = tree_.positions()[corners[2]];
  const double sides[3] = {squared_length(to - from), squared_length(apex - from), squared_length(to - apex)};
  if (sides[1] > sides[0] && sides[1] >= sides[2]) {
    std::swap(apex, to);
  } else if (sides[2] > sides[0]) {
    std::swap(apex, from);
  }
  float along = samples_[i].along;
  for (int k = 0; k < kHalvings; ++k) {
    const Vec3 middle = 0.5 * (from + to);
    along *= 2;
    if (along < 1) {
      to = apex;
    } else {
      from = apex;
      along -= 1;
    }
    apex = middle;
  }
  return (1.0 / 3) * (from + apex + to);
}

}  // namespace isoatlas
