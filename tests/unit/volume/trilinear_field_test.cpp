// SPDX-License-Identifier: Apache-2.0
#include "volume/trilinear_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/vector_math.h"
#include "support/volumes.h"
#include "volume/sample_type.h"

namespace isoatlas {
namespace {

using test::Random;

TEST(TrilinearField, ReproducesTrilinearFunctionsOfEveryType) {
  // 1 + 2x - y + 3z + xy: trilinear, whole numbers at the samples.
  const auto f = [](double x, double y, double z) { return 1 + 2 * x - y + 3 * z + x * y; };
  const test::Samples samples = test::sampled({4, 5, 6}, f, 1);
  for (const SampleType type : test::kAllTypes) {
    const bool has_sign =
        type != SampleType::uint8 && type != SampleType::uint16 && type != SampleType::uint32 && type != SampleType::uint64;
    const std::int64_t offset = has_sign ? 0 : 5;
    const Volume volume = test::to_volume(test::plus(samples, offset), type);
    for (const Inside inside : {Inside::above, Inside::below}) {
      const TrilinearField field(volume, {7.5, inside, NonFinite::refuse});
      const double sign = inside == Inside::above ? 1 : -1;
      Random random(1);
      for (int k = 0; k < 50; ++k) {
        const Vec3 p{3 * random.unit(), 4 * random.unit(), 5 * random.unit()};
        const TrilinearField::Value at = field.at(p);
        EXPECT_NEAR(at.value, sign * (f(p.x, p.y, p.z) + static_cast<double>(offset) - 7.5), 1e-12);
        EXPECT_LT(length(at.gradient - sign * Vec3{2 + p.y, p.x - 1, 3}), 1e-12);
      }
    }
  }
}

TEST(TrilinearField, SamplesAndBorder) {
  const Volume volume = test::to_volume(test::random_samples(test::Family::white_noise, {3, 4, 5}, 2), SampleType::int64);
  const auto* samples = static_cast<const std::int64_t*>(volume.samples);
  const TrilinearField field(volume, {0, Inside::above, NonFinite::refuse});
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

TEST(TrilinearField, ExtremeSamplesKeepTheirRatio) {
  for (const double scale : {1e-300, 1e-160, 1.0, 1e160, 1e300}) {
    Grid grid;
    grid.size = {2, 2, 2};
    const Volume volume = test::own<double>(grid, SampleType::float64, {-scale, scale, -scale, scale, -scale, scale, -scale, scale});
    const TrilinearField::Value at = TrilinearField(volume, {0, Inside::above, NonFinite::refuse}).at({0.75, 0.5, 0.5});
    EXPECT_NEAR(at.value / at.gradient.x, 0.25, 1e-12) << scale;
    EXPECT_GT(at.gradient.x * at.gradient.x, 0) << scale;
    EXPECT_TRUE(std::isfinite(at.gradient.x * at.gradient.x)) << scale;
  }
}

}  // namespace
}  // namespace isoatlas
