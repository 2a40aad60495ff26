// SPDX-License-Identifier: Apache-2.0
#include "geometry/inverted_components.h"

#include <gtest/gtest.h>

#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

// A regular tetrahedron about the origin; at each corner the outward direction is the corner
// itself, at a cosine of 1/3 to the three faces there.
struct Solid {
  std::vector<Vec3> positions{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  std::vector<Triangle> triangles{{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  std::vector<Vec3> outward = positions;
  std::vector<std::uint32_t> component{0, 0, 0, 0};

  std::vector<std::uint8_t> inverted(std::size_t components = 1, double least = 0,
                                     Vec3 spacing = {1, 1, 1}) const {
    return inverted_components(positions, triangles, spacing, component, components, outward,
                               least);
  }
  void turn_over() {
    for (Triangle& t : triangles) std::swap(t[1], t[2]);
  }
};

TEST(InvertedComponents, OutwardAndInverted) {
  Solid solid;
  ASSERT_GT(test::signed_volume({solid.positions, solid.triangles}), 0);
  EXPECT_EQ(solid.inverted(), std::vector<std::uint8_t>{0});
  solid.turn_over();
  EXPECT_EQ(solid.inverted(), std::vector<std::uint8_t>{1});
}

TEST(InvertedComponents, MinCosineIsTheMeanCosine) {
  const Solid solid;
  EXPECT_EQ(solid.inverted(1, 0.33), std::vector<std::uint8_t>{0});
  EXPECT_EQ(solid.inverted(1, 0.34), std::vector<std::uint8_t>{1});
}

TEST(InvertedComponents, EachComponentForItself) {
  Solid two;
  const Solid other;
  for (const Vec3& p : other.positions) two.positions.push_back({p.x + 10, p.y, p.z});
  for (const Triangle& t : other.triangles)
    two.triangles.push_back({t[0] + 4, t[2] + 4, t[1] + 4});  // inverted
  two.outward.insert(two.outward.end(), other.outward.begin(), other.outward.end());
  two.component = {0, 0, 0, 0, 1, 1, 1, 1};
  EXPECT_EQ(two.inverted(2), (std::vector<std::uint8_t>{0, 1}));
}

TEST(InvertedComponents, LengthOfTheDirectionsDoesNotMatter) {
  for (const double scale : {1e-150, 1e-6, 1e6, 1e150, 1e200, 1e300, 1e-200, 1e-300}) {
    Solid solid;
    for (Vec3& d : solid.outward) d = {d.x * scale, d.y * scale, d.z * scale};
    EXPECT_EQ(solid.inverted(), std::vector<std::uint8_t>{0}) << scale;
    solid.turn_over();
    EXPECT_EQ(solid.inverted(), std::vector<std::uint8_t>{1}) << scale;
  }
}

TEST(InvertedComponents, CornersWithoutADirectionAreLeftOut) {
  Solid solid;
  solid.outward[0] = solid.outward[1] = solid.outward[2] = {0, 0, 0};
  EXPECT_EQ(solid.inverted(), std::vector<std::uint8_t>{0});
  solid.turn_over();
  EXPECT_EQ(solid.inverted(), std::vector<std::uint8_t>{1});
}

}  // namespace
}  // namespace isoatlas::detail
