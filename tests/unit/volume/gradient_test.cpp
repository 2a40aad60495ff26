// SPDX-License-Identifier: Apache-2.0
#include "volume/gradient.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/volumes.h"

namespace isoatlas {
namespace {

using namespace test;

Vec3 unit(Vec3 a) {
  const double n = std::hypot(a.x, a.y, a.z);
  return {a.x / n, a.y / n, a.z / n};
}

void expect_direction(Vec3 got, Vec3 want) {
  const Vec3 g = unit(got), w = unit(want);
  EXPECT_NEAR(g.x * w.x + g.y * w.y + g.z * w.z, 1, 1e-9) << g.x << " " << g.y << " " << g.z;
}

// A plane has one direction everywhere, on the volume's far faces as well.
TEST(OutwardDirections, OfAPlane) {
  const std::vector<Vec3> points{{0, 0, 0}, {1.5, 2.25, 0.75}, {5, 6, 7}, {5, 0, 3.5}, {2, 3, 4}};
  for (const Vec3 spacing : {Vec3{1, 1, 1}, Vec3{0.5, 2, 4}}) {
    const Volume volume = to_volume(sampled(
                                        {6, 7, 8}, [](double x, double y, double z) { return 20 - (3 * x + 2 * y - z); }, 1),
                                    SampleType::int16, spacing);
    for (const Inside inside : {Inside::above, Inside::below}) {
      const double sign = inside == Inside::above ? 1 : -1;
      const auto got = outward_directions(volume, {10, inside, NonFinite::refuse}, points);
      ASSERT_EQ(got.size(), points.size());
      for (const Vec3& g : got) expect_direction(g, {sign * 3 / spacing.x, sign * 2 / spacing.y, sign * -1 / spacing.z});
    }
  }
}

TEST(OutwardDirections, OfASpherePointAwayFromItsCentre) {
  const Vec3 c{11.3, 11.6, 11.45};
  const Volume volume = to_volume(sampled({24, 24, 24}, sphere(c, 8.2)));
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Vec3 d = unit({random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5});
    const auto got = outward_directions(volume, {0, Inside::above, NonFinite::refuse},
                                        std::vector<Vec3>{{c.x + 8.2 * d.x, c.y + 8.2 * d.y, c.z + 8.2 * d.z}});
    const Vec3 g = unit(got[0]);
    EXPECT_GT(g.x * d.x + g.y * d.y + g.z * d.z, 0.98);
  }
}

TEST(OutwardDirections, FlatFieldHasNone) {
  const auto got =
      outward_directions(to_volume(constant({3, 3, 3}, 5)), {5, Inside::above, NonFinite::refuse}, std::vector<Vec3>{{1, 1, 1}});
  EXPECT_EQ(got[0], (Vec3{0, 0, 0}));
}

}  // namespace
}  // namespace isoatlas
