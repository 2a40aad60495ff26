// SPDX-License-Identifier: Apache-2.0
#include "field/interpolated_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/vector_math.h"
#include "field/sample_type.h"
#include "support/exact_volume.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using test::Random;

TEST(InterpolatedField, ReproducesTrilinearFunctionsOfEveryType) {
  // 1 + 2x - y + 3z + xy: trilinear, whole numbers at the samples.
  const auto f = [](double x, double y, double z) { return 1 + 2 * x - y + 3 * z + x * y; };
  const test::Samples samples = test::sampled({4, 5, 6}, f, 1);
  for (const SampleType type : test::kAllTypes) {
    const bool has_sign = type != SampleType::uint8 && type != SampleType::uint16 &&
                          type != SampleType::uint32 && type != SampleType::uint64;
    const std::int64_t offset = has_sign ? 0 : 5;
    const Volume volume = test::to_volume(test::plus(samples, offset), type);
    for (const Inside inside : {Inside::above, Inside::below}) {
      const InterpolatedField field(volume, {7.5, inside, NonFinite::refuse});
      const double sign = inside == Inside::above ? 1 : -1;
      Random random(1);
      for (int k = 0; k < 50; ++k) {
        const Vec3 p{3 * random.unit(), 4 * random.unit(), 5 * random.unit()};
        const InterpolatedField::Value at = field.at(p);
        EXPECT_NEAR(at.value, sign * (f(p.x, p.y, p.z) + static_cast<double>(offset) - 7.5), 1e-12);
        EXPECT_LT(length(at.gradient - sign * Vec3{2 + p.y, p.x - 1, 3}), 1e-12);
      }
    }
  }
}

TEST(InterpolatedField, SamplesAndVolumeBoundary) {
  const Volume volume = test::to_volume(
      test::random_samples(test::Family::white_noise, {3, 4, 5}, 2), SampleType::int64);
  const auto* samples = static_cast<const std::int64_t*>(volume.view.samples);
  const InterpolatedField field(volume, {0, Inside::above, NonFinite::refuse});
  EXPECT_EQ(field.last(), (Vec3{2, 3, 4}));
  for (std::size_t z = 0, i = 0; z < 5; ++z) {
    for (std::size_t y = 0; y < 4; ++y) {
      for (std::size_t x = 0; x < 3; ++x, ++i) {
        const Vec3 p{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
        EXPECT_NEAR(field.at(p).value, static_cast<double>(samples[i]), 1e-9);
      }
    }
  }
  EXPECT_EQ(field.at({-3, 1.5, 9}).value, field.at({0, 1.5, 4}).value);
  EXPECT_EQ(field.clamped({-3, 1.5, 9}), (Vec3{0, 1.5, 4}));
}

TEST(InterpolatedField, ExtremeSamplesKeepTheirRatio) {
  for (const double scale : {1e-300, 1e-160, 1.0, 1e160, 1e300}) {
    Grid grid;
    grid.size = {2, 2, 2};
    const Volume volume = test::own<double>(
        grid, SampleType::float64, {-scale, scale, -scale, scale, -scale, scale, -scale, scale});
    const InterpolatedField::Value at =
        InterpolatedField(volume, {0, Inside::above, NonFinite::refuse}).at({0.75, 0.5, 0.5});
    EXPECT_NEAR(at.value / at.gradient.x, 0.25, 1e-12) << scale;
    EXPECT_GT(at.gradient.x * at.gradient.x, 0) << scale;
    EXPECT_TRUE(std::isfinite(at.gradient.x * at.gradient.x)) << scale;
  }
}

Volume smooth_volume(const test::Function& f, Vec3 spacing = {1, 1, 1}) {
  return test::exact_volume({7, 8, 9}, f, spacing);
}

constexpr InsideRule kAtZero{0, Inside::above, NonFinite::refuse};

TEST(TricubicField, ReproducesPolynomialsOfDegreeTwoPerAxis) {
  const auto f = [](double x, double y, double z) {
    return 1 + 2 * x - y + 3 * z + x * x - 2 * y * y + 0.5 * z * z + x * y * z +
           x * x * y * y * z * z / 64;
  };
  const Volume volume = smooth_volume(f);
  const InterpolatedField field(volume, {2.5, Inside::below, NonFinite::refuse},
                                Interpolation::tricubic);
  Random random(1);
  for (int k = 0; k < 200; ++k) {  // in cells that have samples all around
    const double x = 1 + 4 * random.unit(), y = 1 + 5 * random.unit(), z = 1 + 6 * random.unit();
    const InterpolatedField::Value at = field.at({x, y, z});
    EXPECT_NEAR(at.value, 2.5 - f(x, y, z), 1e-10);
    const Vec3 slope{2 + 2 * x + y * z + x * y * y * z * z / 32,
                     -1 - 4 * y + x * z + x * x * y * z * z / 32,
                     3 + z + x * y + x * x * y * y * z / 32};
    EXPECT_LT(length(at.gradient + slope), 1e-10);
  }
}

TEST(TricubicField, IsThroughTheSamplesOfEveryType) {
  const test::Samples samples = test::random_samples(test::Family::white_noise, {5, 2, 4}, 2);
  for (const SampleType type : test::kAllTypes) {
    const bool has_sign = type != SampleType::uint8 && type != SampleType::uint16 &&
                          type != SampleType::uint32 && type != SampleType::uint64;
    const std::int64_t lift = has_sign ? 0 : 120;
    const test::Samples small =
        test::plus(test::random_samples(test::Family::few_values, {5, 2, 4}, 2), lift);
    const Volume volume = test::to_volume(small, type);
    const InterpolatedField field(volume, {0.25, Inside::above, NonFinite::refuse},
                                  Interpolation::tricubic);
    for (std::size_t z = 0; z < 4; ++z) {
      for (std::size_t y = 0; y < 2; ++y) {
        for (std::size_t x = 0; x < 5; ++x) {
          const Vec3 p{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
          EXPECT_EQ(field.at(p).value, static_cast<double>(small.at(x, y, z)) - 0.25);
        }
      }
    }
    EXPECT_EQ(field.at({-3, 0.5, 9}).value, field.at({0, 0.5, 3}).value);
  }
}

TEST(TricubicField, GradientIsThatOfTheValue) {
  const Volume volume =
      test::to_volume(test::random_samples(test::Family::white_noise, {5, 6, 7}, 3));
  const InterpolatedField field(volume, kAtZero, Interpolation::tricubic);
  Random random(4);
  constexpr double h = 1e-6;
  for (int k = 0; k < 300; ++k) {
    const Vec3 p{h + (4 - 2 * h) * random.unit(), h + (5 - 2 * h) * random.unit(),
                 h + (6 - 2 * h) * random.unit()};
    const Vec3 g = field.at(p).gradient;
    const auto slope = [&](Vec3 d) {
      return (field.at(p + h * d).value - field.at(p - h * d).value) / (2 * h);
    };
    EXPECT_LT(length(g - Vec3{slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})}),
              1e-6 * (1 + length(g)));
  }
}

TEST(TricubicField, GradientIsContinuousAcrossCells) {
  const Volume volume =
      test::to_volume(test::random_samples(test::Family::white_noise, {6, 6, 6}, 5));
  const InterpolatedField field(volume, kAtZero, Interpolation::tricubic), kinked(volume, kAtZero);
  Random random(6);
  double largest_kink = 0;
  for (int k = 0; k < 300; ++k) {
    std::array<double, 3> at{5 * random.unit(), 5 * random.unit(), 5 * random.unit()};
    double& across = at[random.bits() % 3];
    across = static_cast<double>(1 + random.bits() % 4);
    const Vec3 above{at[0], at[1], at[2]};
    across = std::nextafter(across, 0);
    const Vec3 below{at[0], at[1], at[2]};
    const Vec3 jump = field.at(above).gradient - field.at(below).gradient;
    EXPECT_LT(length(jump), 1e-9 * (1 + length(field.at(above).gradient)));
    largest_kink =
        std::max(largest_kink, length(kinked.at(above).gradient - kinked.at(below).gradient));
  }
  EXPECT_GT(largest_kink, 1);  // the trilinear field's
}

TEST(TricubicField, ExtremeSamplesKeepTheirRatio) {
  for (const double scale : {1e-310, 1e-160, 1.0, 1e160, 1.7e308}) {
    const Volume volume =
        smooth_volume([&](double x, double, double) { return x < 2.5 ? -scale : scale; });
    const InterpolatedField::Value at =
        InterpolatedField(volume, kAtZero, Interpolation::tricubic).at({2.75, 3.5, 3.5});
    EXPECT_NEAR(at.value / at.gradient.x, 0.59375 / 2.125, 1e-9) << scale;
    EXPECT_TRUE(std::isfinite(at.gradient.x * at.gradient.x)) << scale;
    EXPECT_GT(at.gradient.x * at.gradient.x, 0) << scale;
  }
}

}  // namespace
}  // namespace isoatlas::detail
