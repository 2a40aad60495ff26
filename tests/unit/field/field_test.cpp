// SPDX-License-Identifier: Apache-2.0
#include "field/field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using test::own;
using test::Random;

TEST(Field, IsPositiveInsideForEitherRule) {
  Grid grid;
  grid.size = {4, 1, 1};
  const Volume volume = own<std::int16_t>(grid, SampleType::int16, {-5, 10, 11, 30000});
  const Field<std::int16_t> above(volume, {10.5, Inside::above, NonFinite::refuse});
  const Field<std::int16_t> below(volume, {10.5, Inside::below, NonFinite::refuse});
  EXPECT_EQ(above[0], -15.5);
  EXPECT_EQ(above[1], -0.5);
  EXPECT_EQ(above[2], 0.5);
  EXPECT_EQ(below[2], -0.5);
  EXPECT_EQ(below[3], -29989.5);
  EXPECT_EQ(above.exact(3).high, 30000.0);
}

double difference(const ExactSample& a, const ExactSample& b) {
  return (a.high - b.high) + (a.low - b.low);
}

TEST(Field, ExactKeepsEvery64BitInteger) {
  Grid grid;
  grid.size = {2, 1, 1};
  const Volume big =
      own<std::uint64_t>(grid, SampleType::uint64, {~std::uint64_t{0}, ~std::uint64_t{0} - 1});
  const Field<std::uint64_t> field(big, {0, Inside::above, NonFinite::refuse});
  EXPECT_EQ(difference(field.exact(0), field.exact(1)), 1);
  const Volume low = own<std::int64_t>(
      grid, SampleType::int64,
      {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::min() + 1});
  const Field<std::int64_t> signed_field(low, {0, Inside::above, NonFinite::refuse});
  EXPECT_EQ(difference(signed_field.exact(1), signed_field.exact(0)), 1);
}

TEST(Field, SubstitutesForNonFiniteSamplesAreFiniteAndOnTheirSide) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
  Grid grid;
  grid.size = {6, 1, 1};
  const Volume volume = own<double>(grid, SampleType::float64, {3, nan, inf, -inf, -4, 1});
  for (const NonFinite policy : {NonFinite::above, NonFinite::below}) {
    for (const Inside inside : {Inside::above, Inside::below}) {
      const Field<double> field(volume, {1, inside, policy});
      const double up = inside == Inside::above ? 1 : -1;
      for (std::size_t i = 0; i < 6; ++i) EXPECT_TRUE(std::isfinite(field[i]));
      EXPECT_GT(up * field[2], 0);
      EXPECT_LT(up * field[3], 0);
      EXPECT_GT((policy == NonFinite::above ? up : -up) * field[1], 0);
      EXPECT_EQ(std::abs(field[1]), 5) << "as far from the isovalue as the farthest sample";
    }
  }
}

TEST(TrilinearCell, MatchesTheWeightedSumAndItsSlope) {
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    std::array<double, 8> f;
    for (double& v : f) v = random.unit() * 2 - 1;
    const TrilinearCell cell(f);
    const auto slow = [&](Vec3 p) {
      double sum = 0;
      for (int c = 0; c < 8; ++c) {
        sum += f[c] * (c & 1 ? p.x : 1 - p.x) * (c & 2 ? p.y : 1 - p.y) * (c & 4 ? p.z : 1 - p.z);
      }
      return sum;
    };
    const Vec3 p{random.unit(), random.unit(), random.unit()};
    EXPECT_NEAR(cell.value(p), slow(p), 1e-14);
    const double h = 1e-4;  // exact up to rounding: linear along each axis
    const Vec3 g = cell.gradient(p);
    EXPECT_NEAR(g.x, (slow({p.x + h, p.y, p.z}) - slow({p.x - h, p.y, p.z})) / (2 * h), 1e-10);
    EXPECT_NEAR(g.y, (slow({p.x, p.y + h, p.z}) - slow({p.x, p.y - h, p.z})) / (2 * h), 1e-10);
    EXPECT_NEAR(g.z, (slow({p.x, p.y, p.z + h}) - slow({p.x, p.y, p.z - h})) / (2 * h), 1e-10);
  }
}

}  // namespace
}  // namespace isoatlas::detail
