// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "isoatlas/volume.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using test::own;

TEST(Grid, WorldIsOriginPlusDirectionTimesSpacingTimesIndex) {
  Grid grid;
  grid.size = {4, 5, 6};
  grid.spacing = {2, 3, 0.5};
  grid.origin = {10, 20, 30};
  grid.direction = {Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}};  // a quarter turn about z
  const Vec3 w = grid.to_world({1, 2, 4});
  EXPECT_EQ(w, (Vec3{10 - 6, 20 + 2, 30 + 2}));
  EXPECT_EQ(grid.smallest_spacing(), 0.5);
  EXPECT_EQ(grid.sample_count(), 120u);
  EXPECT_FALSE(grid.mirrored());
  std::swap(grid.direction[0], grid.direction[1]);
  EXPECT_TRUE(grid.mirrored());
}

TEST(Grid, IndexOfWorldIsTheInverse) {
  test::Random random(8);
  const auto vector = [&](double s) {
    return Vec3{s * (random.unit() - 0.5), s * (random.unit() - 0.5), s * (random.unit() - 0.5)};
  };
  for (int k = 0; k < 100; ++k) {
    Grid grid;
    grid.size = {40, 50, 60};
    grid.spacing = {0.5 + random.unit(), 1 + random.unit(), 3 * random.unit() + 0.1};
    grid.origin = vector(1000);
    grid.direction = {vector(2), vector(2), vector(2)};  // sheared and mirrored ones too
    const Vec3 i{40 * random.unit(), 50 * random.unit(), 60 * random.unit()},
        back = grid.to_index(grid.to_world(i));
    const auto& d = grid.direction;
    const double determinant = d[0].x * (d[1].y * d[2].z - d[1].z * d[2].y) -
                               d[0].y * (d[1].x * d[2].z - d[1].z * d[2].x) +
                               d[0].z * (d[1].x * d[2].y - d[1].y * d[2].x);
    const double tolerance = 1e-9 / std::abs(determinant);
    EXPECT_NEAR(back.x, i.x, tolerance);
    EXPECT_NEAR(back.y, i.y, tolerance);
    EXPECT_NEAR(back.z, i.z, tolerance);
  }
}

TEST(SampleType, NamesAndSizes) {
  const std::pair<const char*, std::size_t> expected[] = {
      {"int8", 1},   {"uint8", 1}, {"int16", 2},  {"uint16", 2},  {"int32", 4},
      {"uint32", 4}, {"int64", 8}, {"uint64", 8}, {"float32", 4}, {"float64", 8}};
  for (std::size_t i = 0; i < test::kAllTypes.size(); ++i) {
    EXPECT_EQ(name(test::kAllTypes[i]), expected[i].first);
    EXPECT_EQ(bytes_per_sample(test::kAllTypes[i]), expected[i].second);
  }
}

TEST(Summarize, RangeAndNonFiniteSamples) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
  Grid grid;
  grid.size = {2, 2, 3};
  const Volume volume =
      own<double>(grid, SampleType::float64, {5, 4, 3, nan, inf, -7, -inf, nan, 0, 1, 2, 3});
  const SampleSummary s = summarize(volume);
  EXPECT_EQ(s.minimum, -7);
  EXPECT_EQ(s.maximum, 5);
  EXPECT_EQ(s.nan_count, 2u);
  EXPECT_EQ(s.infinity_count, 2u);
  EXPECT_EQ(s.finite_count, 8u);
  EXPECT_EQ(s.first_non_finite, (std::array<std::size_t, 3>{1, 1, 0}));
}

TEST(Summarize, NothingFinite) {
  Grid grid;
  grid.size = {1, 1, 2};
  const SampleSummary s =
      summarize(own<float>(grid, SampleType::float32, {std::nanf(""), std::nanf("")}));
  EXPECT_EQ(s.finite_count, 0u);
  EXPECT_EQ(s.nan_count, 2u);
}

TEST(Summarize, FarEndsOfEveryType) {
  Grid grid;
  grid.size = {3, 1, 1};
  const SampleSummary u = summarize(own<std::uint64_t>(
      grid, SampleType::uint64, {7, std::numeric_limits<std::uint64_t>::max(), 9}));
  EXPECT_EQ(u.maximum, 0x1p64);
  EXPECT_EQ(u.minimum, 7);
  const SampleSummary i = summarize(
      own<std::int64_t>(grid, SampleType::int64, {7, std::numeric_limits<std::int64_t>::min(), 9}));
  EXPECT_EQ(i.minimum, -0x1p63);
}

}  // namespace
}  // namespace isoatlas::detail
