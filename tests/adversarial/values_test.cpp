// SPDX-License-Identifier: Apache-2.0
// Samples at the limits of their type, and denormal floating-point numbers.
#include <cmath>
#include <limits>
#include <vector>

#include "adversarial/sound_levels.h"
#include "field/sample_type.h"

namespace isoatlas::detail {
namespace {

using namespace test;

/// Meshes random samples out of `values`. Returns false if all samples are on one side.
template <class T>
bool expect_sound_among(const std::vector<T>& values, SampleType type, std::uint64_t seed) try {
  Random random(seed);
  const auto any = [&] { return values[random.bits() % values.size()]; };
  Grid grid;
  for (std::size_t& n : grid.size) n = static_cast<std::size_t>(random.between(2, 6));
  std::vector<T> samples(grid.sample_count());
  for (T& s : samples) s = any();
  // 64-bit values are rounded, so that the isovalue may be outside the range of the type.
  const double isovalue = static_cast<double>(any());
  const Volume volume = own(grid, type, std::move(samples));
  const ExtractOptions options =
      default_levels(volume, isovalue, random.bits() % 2 ? Inside::above : Inside::below);
  expect_sound(volume, options,
               std::string(name(type)) + ", seed " + std::to_string(seed) + ", isovalue " +
                   std::to_string(isovalue));
  return true;
} catch (const Error& e) {
  EXPECT_EQ(e.code(), ErrorCode::empty_surface) << e.what();
  return false;
}

template <class T>
std::vector<T> limits_of_type() {
  using Limits = std::numeric_limits<T>;
  std::vector<T> values{Limits::lowest(), Limits::max(), T{0}, T{1}};
  if constexpr (std::is_integral_v<T>) {
    for (const auto v : {Limits::lowest() + 1, Limits::max() - 1, Limits::max() / 2})
      values.push_back(static_cast<T>(v));
  } else {
    for (const T v :
         {Limits::min(), -Limits::min(), Limits::denorm_min(), -Limits::denorm_min(), -T{0},
          std::nextafter(Limits::max(), T{0}), Limits::max() / 2, T{1} + Limits::epsilon()})
      values.push_back(v);
  }
  return values;
}

template <class T>
std::vector<T> denormals() {
  using Limits = std::numeric_limits<T>;
  std::vector<T> values;
  for (int k = -3; k <= 3; ++k) values.push_back(static_cast<T>(k) * Limits::denorm_min());
  values.push_back(Limits::min());
  values.push_back(-Limits::min());
  return values;
}

TEST(Adversarial, SamplesAtTheLimitsOfTheirType) {
  for (const SampleType type : kAllTypes) {
    visit_sample_type(type, [&]<class T>(const T*) {
      const std::vector<T> values = limits_of_type<T>();
      int meshed = 0;
      const std::uint64_t seeds = is_night() ? 30 : many() ? 8 : 5;
      for (std::uint64_t seed = 0; seed < seeds && !testing::Test::HasFailure(); ++seed)
        meshed += expect_sound_among(values, type, seed);
      EXPECT_GT(meshed, static_cast<int>(seeds / 3)) << name(type);
    });
    if (HasFailure()) return;
  }
}

TEST(Adversarial, Denormals) {
  const auto among = [](SampleType type, const auto& values) {
    int meshed = 0;
    const std::uint64_t seeds = is_night() ? 70 : many() ? 16 : 8;
    for (std::uint64_t seed = 0; seed < seeds && !testing::Test::HasFailure(); ++seed)
      meshed += expect_sound_among(values, type, seed);
    EXPECT_GT(meshed, static_cast<int>(seeds / 3)) << name(type);
  };
  among(SampleType::float32, denormals<float>());
  among(SampleType::float64, denormals<double>());
}

// An annulus and a disk in one grid cell, whose c-vertices are found only by a search.
TEST(Adversarial, SurfelsThatAreHardToSeparate) {
  EXPECT_TRUE(expect_sound_among(limits_of_type<std::uint8_t>(), SampleType::uint8, 48));
}

// Adjacent grid cells whose values are scaled differently: points on their wall were assigned to
// the wrong curve.
TEST(Adversarial, WallBetweenGridCellsWithTinyValues) {
  EXPECT_TRUE(expect_sound_among(denormals<double>(), SampleType::float64, 591));
}

// Slivers that intersect only after their positions are rounded (found by fuzzing).
TEST(Adversarial, SliversThatIntersectOnceRounded) {
  Samples samples;
  samples.size = {5, 2, 5};
  samples.values = {0, 0, 0, 0, 0, 0, 1, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1, 1, 0, 0, 1, 0, 0, 0,
                    1, 0, 1, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0};
  const Volume volume = to_volume(samples, SampleType::uint16, {0.3, 1, 0.7});
  ExtractOptions options = coarse_options();
  options.surface.isovalue = 0;
  options.surface.inside = Inside::below;
  options.space = Space::voxel;
  options.refine = {{{Quantity::normal_angle, 20}}};
  expect_sound(volume, options, "five by two by five");
}

// Two values that are adjacent numbers, or the limits of the type. Saddles depend on which of the
// two is exactly nearer to the isovalue.
TEST(Adversarial, TwoValuesAndAnIsovalueBetween) {
  const Samples pattern = random_samples(Family::signs_only, {6, 5, 7}, 41);
  enum class Nearer { neither, high };
  const auto two = [&](SampleType type, auto low, auto high, double isovalue, Nearer nearer) {
    std::vector<decltype(low)> values;
    for (const std::int64_t v : pattern.values) values.push_back(v > 0 ? high : low);
    Grid grid;
    grid.size = pattern.size;
    const Volume volume = own(grid, type, values);
    ExtractOptions options = default_levels(volume, isovalue);
    for (const Topology topology : {Topology::trilinear, Topology::faces}) {
      options.surface.topology = topology;
      const Extraction e = expect_sound(volume, options, std::string(name(type)));
      const TopologySummary expected =
          reference_topology(pattern, nearer == Nearer::high ? 0.5 : 0);
      EXPECT_EQ(e.report.reference.boundary_loops, expected.boundary_loops)
          << name(type) << " " << isovalue;
      EXPECT_EQ(e.report.reference.euler_characteristic,
                expected.euler_characteristic - 2 * static_cast<std::int64_t>(e.report.tunnels));
    }
  };
  const float one = 1, next = std::nextafter(1.0f, 2.0f);
  const double large = std::numeric_limits<double>::max(),
               least = std::numeric_limits<double>::denorm_min();
  two(SampleType::float32, one, next, 0.5 * (static_cast<double>(one) + static_cast<double>(next)),
      Nearer::neither);
  two(SampleType::float32, one, next, static_cast<double>(next), Nearer::high);
  two(SampleType::float64, 1.0, std::nextafter(1.0, 2.0), std::nextafter(1.0, 2.0), Nearer::high);
  two(SampleType::float64, -least, least, 0, Nearer::neither);
  two(SampleType::float64, 0.0, least, least, Nearer::high);
  two(SampleType::float64, -large, large, 0, Nearer::neither);
  two(SampleType::float64, -large, large, least, Nearer::high);
  two(SampleType::int8, std::int8_t{-128}, std::int8_t{127}, -0.5, Nearer::neither);
  two(SampleType::int8, std::int8_t{-128}, std::int8_t{127}, 0, Nearer::high);
  two(SampleType::uint8, std::uint8_t{254}, std::uint8_t{255}, 254.5, Nearer::neither);
  two(SampleType::int64, std::numeric_limits<std::int64_t>::min(),
      std::numeric_limits<std::int64_t>::max(), -0.5, Nearer::neither);
  two(SampleType::int64, (std::int64_t{1} << 53) - 1, std::int64_t{1} << 53, 0x1p53, Nearer::high);
  two(SampleType::uint64, std::uint64_t{0}, std::numeric_limits<std::uint64_t>::max(), 0x1p63,
      Nearer::high);
}

}  // namespace
}  // namespace isoatlas::detail
