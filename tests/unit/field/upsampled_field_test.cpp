// SPDX-License-Identifier: Apache-2.0
#include "field/upsampled_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/vector_math.h"
#include "field/interpolated_field.h"
#include "field/sample_type.h"
#include "support/exact_volume.h"
#include "support/upsampled.h"

namespace isoatlas::detail {
namespace {

using namespace test;

constexpr Interpolation kBoth[] = {Interpolation::trilinear, Interpolation::tricubic};

Volume small_volume(Family family, std::uint64_t seed, SampleType type = SampleType::int32) {
  return to_volume(random_samples(family, {2 + seed % 5, 4, 3 + seed % 3}, seed), type);
}

TEST(UpsampledField, SamplesEqualTheUpsampledVolume) {
  for (const Interpolation interpolation : kBoth) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      const Volume volume = small_volume(static_cast<Family>(seed % kFamilies), seed);
      const auto factor = static_cast<std::uint32_t>(1 + seed % 5);
      const Inside inside = seed % 2 == 0 ? Inside::above : Inside::below;
      const InsideRule rule{seed % 3 == 0 ? 1.0 : 0.3, inside, NonFinite::refuse};
      const Volume whole = upsampled(volume, interpolation, factor);
      const UpsampledField field(volume, rule, interpolation, factor);
      ASSERT_EQ(field.size(), whole.view.grid.size);
      const Field<double> expected(whole, rule);
      for (std::size_t i = 0; i < whole.view.grid.sample_count(); ++i) {
        ASSERT_EQ(field[i], expected[i]) << seed;
        ASSERT_EQ(field.exact(i).high, expected.exact(i).high) << seed;
        ASSERT_EQ(field.exact(i).low, expected.exact(i).low) << seed;
      }
      const SignBits signs = field.classify({}), other = classify(whole, rule, {});
      ASSERT_EQ(signs.words, other.words);
      ASSERT_EQ(signs.rows_y, other.rows_y);
      ASSERT_EQ(signs.bits, other.bits) << seed;
      ASSERT_EQ(signs.any_inside, other.any_inside);
      ASSERT_EQ(signs.any_outside, other.any_outside);
    }
  }
}

// Large enough for cells far from the surface.
TEST(UpsampledField, SkippedCellsAreOnOneSide) {
  const Samples ball = sampled({18, 19, 20}, sphere({8.6, 9.3, 9.45}, 6), 8),
                noise = random_samples(Family::sparse_specks, {18, 19, 20}, 3);
  for (const Interpolation interpolation : kBoth) {
    for (const Samples& samples : {ball, noise}) {
      const Volume volume = to_volume(samples, SampleType::float32),
                   whole = upsampled(volume, interpolation, 3);
      for (const double isovalue : {-7.0, 0.0, 0.25, 5.5}) {
        for (const Inside inside : {Inside::above, Inside::below}) {
          const InsideRule rule{isovalue, inside, NonFinite::refuse};
          ASSERT_EQ(UpsampledField(volume, rule, interpolation, 3).classify({}).bits,
                    classify(whole, rule, {}).bits)
              << isovalue;
        }
      }
    }
  }
}

// Plateaus at the isovalue are inside, for any isovalue.
TEST(UpsampledField, PlateausStayFlat) {
  for (const Interpolation interpolation : kBoth) {
    for (const double level : {0.1, 1.0 / 3, 1e300, 1.7e308, -1e-310}) {
      Grid grid;
      grid.size = {4, 5, 6};
      const Volume volume = own<double>(grid, SampleType::float64, std::vector<double>(120, level));
      const UpsampledField field(volume, {level, Inside::above, NonFinite::refuse}, interpolation,
                                 7);
      for (std::size_t i = 0; i < field.size()[0] * field.size()[1] * field.size()[2]; ++i)
        ASSERT_EQ(field[i], 0) << level;
      EXPECT_FALSE(field.classify({}).any_outside);
    }
  }
}

// Samples are large where the weights at the centre of the cell are negative, which makes the value
// there exceed all those around it most.
TEST(UpsampledField, CellsThatOvershootAreNotSkipped) {
  const Volume volume = exact_volume({4, 4, 4}, [](double x, double y, double z) {
    const auto outer = [](double a) { return a == 0 || a == 3 ? 1 : 0; };
    return static_cast<double>((outer(x) + outer(y) + outer(z)) % 2);
  });
  const double lowest = -(1.25 * 1.25 * 1.25 - 1) / 2;
  for (const double isovalue : {lowest + 1e-9, lowest - 1e-9}) {
    const InsideRule rule{isovalue, Inside::above, NonFinite::refuse};
    const SignBits signs = UpsampledField(volume, rule, Interpolation::tricubic, 2).classify({});
    EXPECT_EQ(signs.any_outside, isovalue > lowest);
    EXPECT_TRUE(signs.any_inside);
  }
}

TEST(UpsampledField, TricubicCellsArePartsOfTheVolumes) {
  const Volume volume = to_volume(random_samples(Family::white_noise, {4, 5, 3}, 7));
  const InsideRule rule{0.25, Inside::below, NonFinite::refuse};
  const InterpolatedField coarse(volume, rule, Interpolation::tricubic);
  Random random(8);
  for (const std::uint32_t factor : {1u, 2u, 3u, 8u}) {
    const UpsampledField field(volume, rule, Interpolation::tricubic, factor);
    for (int k = 0; k < 200; ++k) {
      std::array<std::size_t, 3> low;
      for (std::size_t a = 0; a < 3; ++a) low[a] = random.bits() % (field.size()[a] - 1);
      Vec3 p{random.unit(), random.unit(), random.unit()};
      const std::array<bool, 3> flat{k % 4 == 1, k % 4 == 2, k % 8 == 1};
      const auto at = TricubicCell(field.around(low, flat)).at(p);
      if (flat[0]) p.x = 0;
      if (flat[1]) p.y = 0;
      if (flat[2]) p.z = 0;
      const Vec3 index = Vec3{static_cast<double>(low[0]), static_cast<double>(low[1]),
                              static_cast<double>(low[2])} +
                         p;
      const InterpolatedField::Value expected = coarse.at((1.0 / factor) * index);
      Vec3 slope = (1.0 / factor) * expected.gradient;
      if (flat[0]) slope.x = 0;
      if (flat[1]) slope.y = 0;
      if (flat[2]) slope.z = 0;
      EXPECT_NEAR(at.value, expected.value, 1e-9);
      EXPECT_LT(length(at.gradient - slope), 1e-9);
    }
  }
}

TEST(UpsampledField, EveryTypeAndExtremes) {
  for (const SampleType type : kAllTypes) {
    const Samples few = plus(random_samples(Family::few_values, {3, 3, 3}, 5), 20);
    const Volume volume = to_volume(few, type), same = to_volume(few, SampleType::float64);
    const InsideRule rule{20.5, Inside::above, NonFinite::refuse};
    for (const Interpolation interpolation : kBoth) {
      const UpsampledField a(volume, rule, interpolation, 3), b(same, rule, interpolation, 3);
      for (std::size_t i = 0; i < 343; ++i) ASSERT_EQ(a[i], b[i]);
    }
  }
  Grid grid;
  grid.size = {2, 2, 2};
  constexpr double kMost = 1.7e308;
  const Volume huge = own<double>(grid, SampleType::float64,
                                  {-kMost, kMost, -kMost, kMost, kMost, -kMost, kMost, kMost});
  for (const Interpolation interpolation : kBoth) {
    const UpsampledField field(huge, {0, Inside::above, NonFinite::refuse}, interpolation, 5);
    for (std::size_t i = 0; i < 216; ++i) ASSERT_TRUE(std::isfinite(field[i]));
    EXPECT_EQ(field[0], -kMost);
    EXPECT_EQ(field[5], kMost);
    const SignBits signs = field.classify({});
    EXPECT_TRUE(signs.any_inside && signs.any_outside);
  }
}

TEST(UpsampledField, NaNNeedsARule) {
  Grid grid;
  grid.size = {3, 2, 2};
  std::vector<double> values(12, 1.0);
  values[4] = NAN;
  values[7] = -INFINITY;
  const Volume volume = own<double>(grid, SampleType::float64, std::move(values));
  const auto classified = [&](NonFinite rule) {
    return UpsampledField(volume, {0, Inside::above, rule}, Interpolation::tricubic, 2)
        .classify({});
  };
  EXPECT_THROW(classified(NonFinite::refuse), Error);
  EXPECT_TRUE(classified(NonFinite::below).any_outside);
  EXPECT_TRUE(classified(NonFinite::above).any_outside) << "the infinite one";
}

TEST(UpsampledField, TooManySamplesAreRefused) {
  const Volume volume = to_volume(random_samples(Family::white_noise, {20, 20, 20}, 1));
  for (const std::uint32_t factor : {1000u, 4294967295u}) {
    try {
      UpsampledField(volume, {}, Interpolation::trilinear, factor);
      ADD_FAILURE() << factor;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_argument);
      EXPECT_EQ(
          std::string(error.what()).find("20 x 20 x 20 samples are too many to supersample by "),
          0u)
          << error.what();
    }
  }
}

}  // namespace
}  // namespace isoatlas::detail
