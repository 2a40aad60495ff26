// SPDX-License-Identifier: Apache-2.0
// Normals that are smooth inside faces and jump at sharp edges.
#include "drawing/shading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "core/vector_math.h"

namespace isoatlas::detail::drawing {
namespace {

// A roof: two rectangles that share the ridge from (0, 0, 0) to (0, 1, 0) and fall by `degrees` on
// each side. Vertices 2 and 3 are on the ridge.
TriangleMesh roof(double degrees) {
  const double c = std::cos(degrees * std::numbers::pi / 180),
               s = std::sin(degrees * std::numbers::pi / 180);
  return {{{-c, 0, -s}, {-c, 1, -s}, {0, 0, 0}, {0, 1, 0}, {c, 0, -s}, {c, 1, -s}},
          {{0, 2, 1}, {1, 2, 3}, {2, 4, 3}, {3, 4, 5}}};
}

void expect_near(Vec3 a, Vec3 b) { EXPECT_LT(length(a - b), 1e-12); }

TEST(Shading, ASmoothEdgeIsShared) {
  const ShadedMesh shaded = split_at_sharp_edges(roof(20), 50);
  EXPECT_EQ(shaded.mesh.positions.size(), 6u);
  EXPECT_EQ(shaded.normals.size(), 6u);
  const std::uint32_t ridge = shaded.mesh.triangles[0][1];
  expect_near(shaded.mesh.positions[ridge], {0, 0, 0});
  expect_near(shaded.normals[ridge], {0, 0, 1});
}

TEST(Shading, ASharpEdgeIsSplit) {
  const ShadedMesh shaded = split_at_sharp_edges(roof(30), 50);  // they differ by 60 degrees
  EXPECT_EQ(shaded.mesh.positions.size(), 8u);
  const auto& triangles = shaded.mesh.triangles;
  EXPECT_NE(triangles[1][2], triangles[3][0]);
  for (std::size_t t = 0; t < 4; ++t) {
    for (const std::uint32_t v : triangles[t])
      expect_near(shaded.normals[v], {t < 2 ? -0.5 : 0.5, 0, std::sqrt(0.75)});
  }
}

TEST(Shading, PositionsOfTrianglesStay) {
  const TriangleMesh mesh = roof(80);
  const ShadedMesh shaded = split_at_sharp_edges(mesh, 50);
  ASSERT_EQ(shaded.mesh.triangles.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(shaded.mesh.positions[shaded.mesh.triangles[t][k]],
                mesh.positions[mesh.triangles[t][k]]);
}

// The edge of a cap of a closed cylinder: every vertex occurs once in the side and once in its cap.
TEST(Shading, TheEdgeOfACapIsSplit) {
  constexpr std::uint32_t n = 24;
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    mesh.positions.push_back({std::cos(angle), std::sin(angle), -1});
    mesh.positions.push_back({std::cos(angle), std::sin(angle), 1});
  }
  mesh.positions.push_back({0, 0, -1});
  mesh.positions.push_back({0, 0, 1});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % n);
    mesh.triangles.push_back({a, b, a + 1});
    mesh.triangles.push_back({b, b + 1, a + 1});
    mesh.triangles.push_back({2 * n, b, a});
    mesh.triangles.push_back({2 * n + 1, a + 1, b + 1});
  }
  const ShadedMesh shaded = split_at_sharp_edges(mesh, 50);
  EXPECT_EQ(shaded.mesh.positions.size(), 4 * n + 2);
  for (std::size_t v = 0; v < shaded.normals.size(); ++v) {
    const Vec3 p = shaded.mesh.positions[v], normal = shaded.normals[v];
    if (std::fabs(normal.z) < 0.5)
      expect_near(normal, {p.x, p.y, 0});
    else
      expect_near(normal, {0, 0, p.z});
  }
}

// Around the tip of a cone of six steep triangles every edge is sharp; around that of a flat one,
// none is.
TEST(Shading, ATipIsSplitIfAllItsEdgesAreSharp) {
  const auto points_at_tip = [](double height) {
    TriangleMesh cone;
    for (int i = 0; i < 6; ++i)
      cone.positions.push_back(
          {std::cos(i * std::numbers::pi / 3), std::sin(i * std::numbers::pi / 3), 0});
    cone.positions.push_back({0, 0, height});
    for (std::uint32_t i = 0; i < 6; ++i) cone.triangles.push_back({i, (i + 1) % 6, 6});
    std::set<std::uint32_t> tips;
    for (const Triangle& t : split_at_sharp_edges(cone, 50).mesh.triangles) tips.insert(t[2]);
    return tips.size();
  };
  EXPECT_EQ(points_at_tip(10), 6u);
  EXPECT_EQ(points_at_tip(0.2), 1u);
}

TEST(Shading, OppositeOrientationsAndManyTrianglesAreSharp) {
  TriangleMesh mesh = roof(0);
  std::swap(mesh.triangles[2][0], mesh.triangles[2][1]);
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  EXPECT_EQ(split_at_sharp_edges(mesh, 50).mesh.positions.size(), 8u);
  mesh = roof(0);
  mesh.positions.push_back({0, 0, 1});
  mesh.triangles.push_back({2, 3, 6});  // a third triangle at the ridge
  EXPECT_EQ(split_at_sharp_edges(mesh, 50).mesh.positions.size(), 8u + 3);
}

TEST(Shading, TrianglesWithoutAreaSplitNothing) {
  TriangleMesh mesh = roof(0);
  mesh.positions.push_back({0, 0.5, 0});  // on the ridge
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {2, 6, 3}, {2, 4, 6}, {6, 4, 5}, {6, 5, 3}};
  const ShadedMesh shaded = split_at_sharp_edges(mesh, 50);
  EXPECT_EQ(shaded.mesh.positions.size(), 7u);
  for (const Vec3 normal : shaded.normals) expect_near(normal, {0, 0, 1});
}

TEST(Shading, AnEmptyMesh) {
  EXPECT_TRUE(split_at_sharp_edges(TriangleMesh{}, 50).normals.empty());
}

}  // namespace
}  // namespace isoatlas::detail::drawing
