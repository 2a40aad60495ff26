// SPDX-License-Identifier: Apache-2.0
#include "geometry/output_positions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "field/to_space.h"
#include "geometry/intersection_tracker.h"
#include "isoatlas/extract.h"

namespace isoatlas::detail {
namespace {

Grid turned_grid(Vec3 origin) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  return {.size = {50, 40, 30},
          .spacing = {0.3, 0.3, 1.1},
          .origin = origin,
          .direction = {{{c, s, 0}, {-s, c, 0}, {0, 0, 1}}}};
}

// Equals to the last bit what extract() returns: the mesh goes through transform_to().
TEST(OutputPositions, FirstFormIsThatOfTheOutput) {
  const Grid grid = turned_grid({-71.3, 12.9, 1e7});
  for (const Space space : {Space::lps, Space::ras, Space::voxel}) {
    TriangleMesh mesh;
    for (int i = 0; i < 100; ++i) mesh.positions.push_back({i / 7.0, 3 + i / 11.0, i / 13.0});
    const std::vector<Vec3> forms = OutputPositions(grid, space, 3).in_form(0, mesh.positions);
    for (Vec3& p : mesh.positions) p = {p.x / 3, p.y / 3, p.z / 3};
    transform_to(mesh, grid, space);
    EXPECT_EQ(forms, mesh.positions);
  }
}

TEST(OutputPositions, Float32OfStlAndGlb) {
  const Grid grid = turned_grid({100, 200, 30});
  const OutputPositions forms(grid, Space::lps, 1);
  ASSERT_EQ(forms.form_count(), 3U) << "double, .stl and .glb";
  const std::vector<Vec3> at{{1.3, 2.4, 3.5}};
  const Vec3 p = to_space(grid, Space::lps, at[0]), origin = float32_origin(grid, Space::lps);
  const auto as_float = [](double x) {
    const volatile float y = static_cast<float>(x);  // volatile: g++ 12 drops such conversions
    return static_cast<double>(y);
  };
  EXPECT_EQ(forms.in_form(1, at)[0], (Vec3{as_float(p.x), as_float(p.y), as_float(p.z)}));
  EXPECT_EQ(forms.in_form(2, at)[0],
            (Vec3{as_float(p.x - origin.x), as_float(p.y - origin.y), as_float(p.z - origin.z)}));
  EXPECT_EQ(as_float(origin.x), origin.x);
}

TEST(OutputPositions, OnlyOneFloat32NearTheOrigin) {
  const Grid grid = turned_grid({-3, -5, -15});
  EXPECT_EQ(float32_origin(grid, Space::lps), Vec3{});
  EXPECT_EQ(OutputPositions(grid, Space::lps, 1).form_count(), 2U);
  EXPECT_EQ(OutputPositions(grid, Space::voxel, 1).form_count(), 2U);
}

// 2^24 voxels from the origin float32 has one step per voxel, in which no mesh can be embedded;
// relative to the centre it can.
TEST(OutputPositions, NoFloat32WhereItRoundsTooMuch) {
  const OutputPositions far(turned_grid({5e6, 0, 0}), Space::lps, 1);
  ASSERT_EQ(far.form_count(), 2U);
  EXPECT_LT(std::fabs(far.in_form(1, std::vector<Vec3>{{25, 20, 15}})[0].x), 20)
      << "the one from the middle";
  Grid beyond = turned_grid({1e300, 0, 0});
  EXPECT_EQ(OutputPositions(beyond, Space::lps, 1).form_count(), 1U);
}

// Disjoint in double precision, in one plane in float32.
TEST(OutputPositions, TrianglesThatIntersectOnlyAsFloat32) {
  const Grid grid{.size = {50, 50, 50},
                  .spacing = {1, 1, 1},
                  .origin = {},
                  .direction = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  std::vector<Vec3> positions{{40, 10, 40},        {44, 10, 40},        {40, 14, 40},
                              {41, 11, 40 + 1e-9}, {44, 11, 40 + 1e-9}, {41, 14, 40 + 1e-9}};
  const std::vector<Triangle> triangles{{0, 1, 2}, {3, 4, 5}};
  IntersectionTracker exact, forms(OutputPositions(grid, Space::lps, 1));
  EXPECT_TRUE(exact.update(positions, triangles, {}).empty());
  EXPECT_EQ(forms.update(positions, triangles, {}).size(), 6U);
  EXPECT_EQ(forms.pair_count(), 1U);
  for (std::size_t v = 3; v < 6; ++v) positions[v].z += 0.001;
  EXPECT_TRUE(forms.update(positions, triangles, {}).empty());
}

TEST(OutputPositions, TriangleThatHasNoAreaAsFloat32) {
  const Grid grid{.size = {50, 50, 50},
                  .spacing = {1, 1, 1},
                  .origin = {},
                  .direction = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  std::vector<Vec3> positions{{40, 10, 40}, {42, 10, 40 + 1e-9}, {44, 10, 40},
                              {40, 30, 30}, {42, 30, 30},        {44, 30, 31}};
  const std::vector<Triangle> triangles{{0, 1, 2}, {3, 4, 5}};
  IntersectionTracker exact, forms(OutputPositions(grid, Space::lps, 1));
  EXPECT_TRUE(exact.update(positions, triangles, {}).empty());
  EXPECT_EQ(forms.update(positions, triangles, {}), (std::vector<std::uint32_t>{0, 1, 2}));
  positions[3].x = 41;  // another position: results for the other vertices stay valid
  EXPECT_EQ(forms.update(positions, triangles, {}), (std::vector<std::uint32_t>{0, 1, 2}));
  positions[1].z = 40.5;
  EXPECT_TRUE(forms.update(positions, triangles, {}).empty());
}

}  // namespace
}  // namespace isoatlas::detail
