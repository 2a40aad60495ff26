// SPDX-License-Identifier: Apache-2.0
#include "error/area_samples.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/vector_math.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

TEST(AreaSamples, EachRepresentsTheSameArea) {
  // Two triangles, one nine times as large as the other.
  const TriangleMesh mesh{{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {5, 5, 5}, {6, 5, 5}, {5, 6, 5}},
                          {{0, 1, 2}, {3, 4, 5}}};
  const AreaSamples samples(mesh.positions, mesh.triangles, 10000);
  EXPECT_DOUBLE_EQ(samples.area(), 5);
  int small = 0, near_corner = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3 p = samples.point(i);
    small += p.z > 4;
    near_corner += p.z < 1 && p.x + p.y < 1;  // a ninth of the large one
    EXPECT_EQ(samples.triangle(i), p.z > 4 ? 1u : 0u);
    EXPECT_GE(std::min(p.x, p.y), 0);
  }
  EXPECT_EQ(small, 1000);
  EXPECT_NEAR(near_corner, 1000, 30);
}

// For integrals over a triangle the error falls nearly as 1 / samples, faster than for random
// samples.
TEST(AreaSamples, SpreadWellInOneTriangle) {
  const TriangleMesh mesh{{{0, 0, 0}, {4, 0, 0}, {1, 2, 0}}, {{0, 1, 2}}};
  for (const std::size_t n : {10, 100, 1000, 10000, 65536}) {
    const AreaSamples samples(mesh.positions, mesh.triangles, n);
    double x = 0, xx = 0, step = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 p = samples.point(i);
      x += p.x / static_cast<double>(n);
      xx += p.x * p.x / static_cast<double>(n);
      if (i > 0) step = std::max(step, length(p - samples.point(i - 1)));
    }
    EXPECT_NEAR(x, 5.0 / 3, 2.0 / static_cast<double>(n));
    EXPECT_NEAR(xx, (16 + 1 + 4) / 6.0, 8.0 / static_cast<double>(n));
    EXPECT_LT(
        step,
        8 / std::sqrt(static_cast<double>(n)));  // consecutive samples are close to each other
  }
}

TEST(AreaSamples, TrianglesWithoutArea) {
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 0, 0}, {0, 1, 2}, {1, 1, 1}}};
  const AreaSamples samples(mesh.positions, mesh.triangles, 30);
  EXPECT_EQ(samples.area(), 0);
  std::vector<int> count(3);
  for (std::size_t i = 0; i < 30; ++i) ++count[samples.triangle(i)];
  EXPECT_EQ(count, (std::vector<int>{10, 10, 10}));
}

}  // namespace
}  // namespace isoatlas::detail
