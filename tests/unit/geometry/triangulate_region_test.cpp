// SPDX-License-Identifier: Apache-2.0
#include "geometry/triangulate_region.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using namespace test;

struct Region {
  std::vector<PlanePoint> points;
  std::vector<RegionSide> sides;

  // Adds a polygon. Counter-clockwise, the region is in it.
  void add(const std::vector<PlanePoint>& corners) {
    const auto first = static_cast<std::uint32_t>(points.size()),
               n = static_cast<std::uint32_t>(corners.size());
    points.insert(points.end(), corners.begin(), corners.end());
    for (std::uint32_t k = 0; k < n; ++k) sides.push_back({first + k, first + (k + 1) % n});
  }
  auto triangulated() const { return triangulate_region(points, sides); }
};

double area_of(const std::vector<PlanePoint>& corners) {
  double twice = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const PlanePoint a = corners[k], b = corners[(k + 1) % corners.size()];
    twice += a.u * b.v - b.u * a.v;
  }
  return twice / 2;
}

// A polygon around a point, each corner at its own random distance from it. Coordinates are
// multiples of 2^-8, so that areas are exact and several corners have the same u.
std::vector<PlanePoint> star(Random& random, PlanePoint centre, double size, int corners) {
  std::vector<PlanePoint> out;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners,
                 radius = size * (0.4 + 0.6 * random.unit());
    const auto whole = [](double x) { return std::round(256 * x) / 256; };
    out.push_back(
        {whole(centre.u + radius * std::cos(angle)), whole(centre.v + radius * std::sin(angle))});
  }
  return out;
}

// Checks a triangulation: all triangles counter-clockwise, their area that of the region, sides in
// one triangle, other edges in two.
void expect_correct(const Region& region, double area) {
  const auto triangles = region.triangulated();
  ASSERT_TRUE(triangles.has_value());
  double sum = 0;
  std::map<RegionSide, int> edges;
  for (const Triangle& t : *triangles) {
    const double one = area_of({region.points[t[0]], region.points[t[1]], region.points[t[2]]});
    EXPECT_GT(one, 0);
    sum += one;
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  }
  EXPECT_EQ(sum, area);
  for (const RegionSide& side : region.sides) {
    EXPECT_EQ((edges[side]), 1);
    EXPECT_EQ((edges.count({side[1], side[0]})), 0u);
    edges.erase(side);
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ((edges.count({edge[1], edge[0]})), 1u);
  }
}

TEST(TriangulateRegion, RandomPolygonsWithHoles) {
  Random random(5);
  for (int k = 0; k < 400; ++k) {
    Region region;
    const int corners = static_cast<int>(random.between(3, 40));
    const std::vector<PlanePoint> outer = star(random, {0, 0}, 100, corners + 4);
    region.add(outer);
    double area = area_of(outer);
    const std::int64_t holes = random.between(0, 3);
    for (std::int64_t h = 0; h < holes; ++h) {
      std::vector<PlanePoint> hole =
          star(random, {12.0 * static_cast<double>(h) - 12, 0}, 5, corners);
      std::reverse(hole.begin(), hole.end());
      region.add(hole);
      area += area_of(hole);
      // An island in the hole, and a second region beside all.
      const std::vector<PlanePoint> island =
          star(random, {12.0 * static_cast<double>(h) - 12, 0}, 1.5, corners);
      region.add(island);
      area += area_of(island);
    }
    const std::vector<PlanePoint> other = star(random, {300, 7}, 50, corners);
    region.add(other);
    area += area_of(other);
    expect_correct(region, area);
    if (HasFailure()) FAIL() << "region " << k;
  }
}

// Points along straight sides, as on the edges of a volume.
TEST(TriangulateRegion, PointsOnOneLine) {
  Region region;
  std::vector<PlanePoint> square;
  for (int k = 0; k < 10; ++k) square.push_back({static_cast<double>(k), 0});
  for (int k = 0; k < 10; ++k) square.push_back({10, static_cast<double>(k)});
  for (int k = 0; k < 10; ++k) square.push_back({static_cast<double>(10 - k), 10});
  for (int k = 0; k < 10; ++k) square.push_back({0, static_cast<double>(10 - k)});
  region.add(square);
  region.add({{2, 2}, {2, 5}, {2, 8}, {5, 8}, {8, 8}, {8, 5}, {8, 2}, {5, 2}});
  expect_correct(region, 100 - 36);
}

// The circle through the corners of a triangle has no other corner inside: long thin triangles are
// only where the polygon requires them.
TEST(TriangulateRegion, IsDelaunay) {
  Region region;
  std::vector<PlanePoint> circle;
  for (int k = 0; k < 60; ++k) {
    const double angle = 2 * std::numbers::pi * k / 60;
    circle.push_back({(10 + (k % 2)) * std::cos(angle), (10 + (k % 2)) * std::sin(angle)});
  }
  region.add(circle);
  const auto triangles = region.triangulated();
  ASSERT_TRUE(triangles.has_value());
  for (const Triangle& t : *triangles) {
    const PlanePoint a = region.points[t[0]], b = region.points[t[1]], c = region.points[t[2]];
    // At a square scale, a shortest edge that is as long as the pitch of the points allows.
    const double shortest =
        std::min({std::hypot(a.u - b.u, a.v - b.v), std::hypot(b.u - c.u, b.v - c.v),
                  std::hypot(c.u - a.u, c.v - a.v)});
    for (const PlanePoint& p : region.points) {
      const double ax = a.u - p.u, ay = a.v - p.v, bx = b.u - p.u, by = b.v - p.v, cx = c.u - p.u,
                   cy = c.v - p.v;
      const double inside = (ax * ax + ay * ay) * (bx * cy - cx * by) -
                            (bx * bx + by * by) * (ax * cy - cx * ay) +
                            (cx * cx + cy * cy) * (ax * by - bx * ay);
      EXPECT_LT(inside, 1e-5 * (1 + shortest));
    }
  }
}

TEST(TriangulateRegion, RefusesSidesThatBoundNoRegion) {
  const std::vector<PlanePoint> square{{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  const std::vector<PlanePoint> inner{{1, 1}, {2, 1}, {2, 2}, {1, 2}};
  const auto reversed = [](std::vector<PlanePoint> polygon) {
    std::reverse(polygon.begin(), polygon.end());
    return polygon;
  };
  const auto is_refused = [](const std::vector<std::vector<PlanePoint>>& polygons) {
    Region region;
    for (const auto& polygon : polygons) region.add(polygon);
    return !region.triangulated();
  };
  EXPECT_FALSE(is_refused({square}));
  EXPECT_FALSE(is_refused({square, reversed(inner)}));
  EXPECT_TRUE(is_refused({square, inner})) << "twice inside";
  EXPECT_TRUE(is_refused({reversed(square)})) << "the outside of a polygon";
  EXPECT_TRUE(is_refused({reversed(square), inner}));
  EXPECT_TRUE(is_refused({{{0, 0}, {4, 4}, {4, 0}, {0, 4}}})) << "crosses itself";
  EXPECT_TRUE(is_refused({square, {{3, 3}, {6, 3}, {6, 6}, {3, 6}}})) << "two overlap";
  EXPECT_TRUE(is_refused({square, reversed({{3, 3}, {6, 3}, {6, 6}, {3, 6}})}));
  EXPECT_TRUE(is_refused({square, reversed({{7, 7}, {8, 7}, {8, 8}, {7, 8}})})) << "a hole outside";
  EXPECT_TRUE(is_refused({{{0, 0}, {4, 0}}})) << "no area";
  EXPECT_TRUE(is_refused({{{0, 0}, {2, 0}, {4, 0}}}));
  const std::vector<PlanePoint> points{{0, 0}, {1, 0}, {0, 1}};
  EXPECT_FALSE(triangulate_region(points, std::vector<RegionSide>{{0, 1}, {1, 2}})) << "open";
  EXPECT_FALSE(
      triangulate_region(points, std::vector<RegionSide>{{0, 1}, {1, 2}, {2, 0}, {0, 2}, {2, 0}}));
}

}  // namespace
}  // namespace isoatlas::detail
