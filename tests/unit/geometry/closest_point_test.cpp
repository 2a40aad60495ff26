// SPDX-License-Identifier: Apache-2.0
#include "geometry/closest_point.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using test::Random;

// The square root of the distance to the best of a fine lattice of points of the triangle: slow,
// and an upper bound.
double lattice_distance(Vec3 p, Vec3 a, Vec3 b, Vec3 c, int n) {
  double best = INFINITY;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j) {
      const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
      best = std::min(best, length(p - (a + (u * (b - a) + v * (c - a)))));
    }
  }
  return best;
}

void expect_point_of_triangle(const TrianglePoint& found, Vec3 p, Vec3 a, Vec3 b, Vec3 c,
                              double scale) {
  double sum = 0;
  for (const double w : found.weight) {
    EXPECT_GE(w, 0);
    sum += w;
  }
  EXPECT_NEAR(sum, 1, 1e-12);
  const Vec3 again = found.weight[0] * a + (found.weight[1] * b + found.weight[2] * c);
  EXPECT_LE(length(again - found.point), 1e-9 * scale);
  EXPECT_EQ(found.squared_distance, squared_length(p - found.point));
}

TEST(ClosestPoint, EveryRegionOfATriangle) {
  const Vec3 a{0, 0, 0}, b{4, 0, 0}, c{0, 3, 0};
  const auto at = [&](Vec3 p) { return closest_on_triangle(p, a, b, c).point; };
  EXPECT_EQ(at({1, 1, 5}), (Vec3{1, 1, 0}));  // above the inside
  EXPECT_EQ(at({-1, -2, 1}), a);              // corners
  EXPECT_EQ(at({6, -1, -1}), b);
  EXPECT_EQ(at({-1, 5, 0}), c);
  EXPECT_EQ(at({2, -3, 1}), (Vec3{2, 0, 0}));  // sides
  EXPECT_EQ(at({-2, 1, 1}), (Vec3{0, 1, 0}));
  const Vec3 q = at({2 + 3, 1.5 + 4, 2});
  EXPECT_NEAR(q.x, 2, 1e-15);
  EXPECT_NEAR(q.y, 1.5, 1e-15);
  EXPECT_EQ(at({1, 1, 0}), (Vec3{1, 1, 0}));  // on it
}

TEST(ClosestPoint, RandomTrianglesAgainstALattice) {
  Random random(3);
  const auto point = [&](double s) {
    return Vec3{s * (random.unit() - 0.5), s * (random.unit() - 0.5), s * (random.unit() - 0.5)};
  };
  for (int k = 0; k < 2000; ++k) {
    const Vec3 a = point(2), b = point(2), c = point(2), p = point(k % 2 ? 3 : 12);
    const TrianglePoint found = closest_on_triangle(p, a, b, c);
    expect_point_of_triangle(found, p, a, b, c, 1);
    const double slow = lattice_distance(p, a, b, c, 60);
    EXPECT_LE(std::sqrt(found.squared_distance), slow + 1e-12);
    EXPECT_GE(std::sqrt(found.squared_distance), slow - 2.0 * 2 / 60);
  }
}

// Points, segments, and triangles so thin that their normal is rounding error: never farther than
// the closest point of the sides.
TEST(ClosestPoint, WithoutArea) {
  Random random(4);
  for (int k = 0; k < 4000; ++k) {
    const double scale = std::pow(10.0, static_cast<double>(random.between(-12, 12)));
    const auto point = [&] {
      return Vec3{scale * (random.unit() - 0.5), scale * (random.unit() - 0.5),
                  scale * (random.unit() - 0.5)};
    };
    const Vec3 a = point(), end = point(), p = point();
    const double t = random.unit() * 3 - 1,
                 thin =
                     k % 3 == 0 ? 0 : std::pow(10.0, static_cast<double>(random.between(-18, -5)));
    const Vec3 b = k % 7 == 0 ? a : end;
    const Vec3 c = a + t * (b - a) + thin * point();
    const TrianglePoint found = closest_on_triangle(p, a, b, c);
    expect_point_of_triangle(found, p, a, b, c, scale);
    double best = INFINITY;
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      const Vec3 q = from + closest_on_segment(p, from, to) * (to - from);
      best = std::min(best, length(p - q));
    }
    EXPECT_LE(std::sqrt(found.squared_distance), best + 1e-10 * scale) << k;
    EXPECT_GE(std::sqrt(found.squared_distance), best - 2 * std::max(thin, 1e-10) * scale) << k;
  }
}

}  // namespace
}  // namespace isoatlas::detail
