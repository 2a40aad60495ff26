// SPDX-License-Identifier: Apache-2.0
// Sizes of components against closed forms, and against the same volume padded with samples
// outside.
#include "complex/component_sizes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "isosurface/parse_surface.h"
#include "support/surfaces.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using namespace test;

double ball(double radius) { return 4 * std::numbers::pi / 3 * radius * radius * radius; }

struct Sized {
  std::vector<ComponentTopology> components;
  ComponentSizes sizes;
  double of(ComponentId c) const { return sizes.enclosed[sizes.part_of[c]]; }
};

SurfaceComplex parsed(const Samples& samples, bool closed, Vec3 spacing = {1, 1, 1},
                      ParseOptions options = {}) {
  Volume volume = to_volume(samples);
  volume.view.grid.spacing = spacing;
  options.closed = closed;
  return parse_surface(volume, options);
}

Sized sized(const Samples& samples, Vec3 spacing = {1, 1, 1}) {
  Sized out;
  const SurfaceComplex complex = parsed(samples, false, spacing);
  out.components = count_manifold(complex).components;
  const SurfaceComplex closed = parsed(samples, true, spacing);
  out.sizes = component_sizes(complex, find_components(complex), closed, find_components(closed));
  return out;
}

Samples padded(const Samples& samples, std::int64_t value) {
  Samples out = constant({samples.size[0] + 2, samples.size[1] + 2, samples.size[2] + 2}, value);
  for (std::size_t z = 0; z < samples.size[2]; ++z) {
    for (std::size_t y = 0; y < samples.size[1]; ++y) {
      for (std::size_t x = 0; x < samples.size[0]; ++x)
        out.at(x + 1, y + 1, z + 1) = samples.at(x, y, z);
    }
  }
  return out;
}

TEST(ComponentSizes, OfBallsAndShells) {
  const Function balls = unite(sphere({8.3, 8.4, 8.6}, 6), sphere({22.4, 8.5, 8.3}, 3));
  const Sized two = sized(sampled({28, 18, 18}, balls), {1, 2, 0.5});
  ASSERT_EQ(two.components.size(), 2U);
  EXPECT_NEAR(std::max(two.of(0), two.of(1)), ball(6), 0.04 * ball(6))
      << "a spacing of volume 1; chords cut off a little";
  EXPECT_NEAR(std::min(two.of(0), two.of(1)), ball(3), 0.12 * ball(3));

  // A cavity is a component of its own, as large as its volume.
  const Sized shells = sized(sampled({24, 24, 24}, nested_shells({11.4, 11.6, 11.3}, {9, 5})));
  ASSERT_EQ(shells.components.size(), 2U);
  EXPECT_NEAR(std::max(shells.of(0), shells.of(1)), ball(9), 0.02 * ball(9));
  EXPECT_NEAR(std::min(shells.of(0), shells.of(1)), ball(5), 0.05 * ball(5));
}

TEST(ComponentSizes, IncludeTheCapOnTheVolumeBoundary) {
  // The box below the sheet, whose sides are those of the volume: 15 x 15 x 7.5.
  const Sized sheet = sized(sampled({16, 16, 16}, half_space({0, 0, 1}, 7.5)));
  ASSERT_EQ(sheet.components.size(), 1U);
  EXPECT_NEAR(sheet.of(0), 15 * 15 * 7.5, 15 * 15 * 0.1);

  // Half a ball, and a quarter of one at an edge of the volume.
  const Sized half = sized(sampled({24, 24, 24}, sphere({11.5, 11.5, 0}, 8)));
  EXPECT_NEAR(half.of(0), ball(8) / 2, 0.03 * ball(8));
  const Sized quarter = sized(sampled({24, 24, 24}, sphere({0, 11.5, 0}, 8)));
  EXPECT_NEAR(quarter.of(0), ball(8) / 4, 0.02 * ball(8));
}

// A slab that goes through the whole volume has two sides, neither of which encloses a volume
// without the other.
TEST(ComponentSizes, ComponentsConnectedByTheCapAreOnePart) {
  Samples samples = sampled({20, 20, 40}, sphere({9.5, 9.5, 12}, 7));
  for (std::size_t y = 0; y < 20; ++y) {
    for (std::size_t x = 0; x < 20; ++x) {
      for (const std::size_t z : {30, 31, 32}) samples.at(x, y, z) = 1000;
    }
  }
  const Sized both = sized(samples);
  ASSERT_EQ(both.components.size(), 3U);
  std::map<std::uint32_t, int> parts;
  for (const std::uint32_t part : both.sizes.part_of) ++parts[part];
  ASSERT_EQ(parts.size(), 2U);
  for (ComponentId c = 0; c < 3; ++c) {
    const bool is_slab = both.components[c].boundary_loops > 0;
    EXPECT_EQ(parts[both.sizes.part_of[c]], is_slab ? 2 : 1);
    EXPECT_NEAR(both.of(c), is_slab ? 19 * 19 * 3 : ball(7), 0.35 * ball(7));
  }
}

TEST(ComponentSizes, AllOfTheVolumeButAHole) {
  // The outside is a tube through the volume.
  const Sized tube = sized(sampled(
      {20, 20, 20}, [](double x, double y, double) { return std::hypot(x - 9.5, y - 9.5) - 5; }));
  ASSERT_EQ(tube.components.size(), 1U);
  EXPECT_NEAR(tube.of(0), 19 * 19 * 19 - std::numbers::pi * 25 * 19, 0.03 * 19 * 19 * 19);
}

// In a volume padded with samples outside, every part is a component with the same topology,
// for any samples.
TEST(ComponentSizes, ClosedSurfacesAreThoseOfPaddedVolumes) {
  for (const Family family :
       {Family::white_noise, Family::few_values, Family::gyroid_cut, Family::checkerboard}) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      const Samples samples =
          random_samples(family, {2 + seed % 5, 2 + seed / 5 % 4, 2 + seed / 20}, seed);
      for (const Topology topology : {Topology::faces, Topology::trilinear}) {
        ParseOptions options;
        options.topology = topology;
        const SurfaceComplex closed = parsed(samples, true, {1, 1, 1}, options);
        ASSERT_EQ(validate(closed), "") << seed;
        ASSERT_TRUE(closed.boundary.empty());
        std::vector<ComponentTopology> found = count_manifold(closed).components;
        std::vector<ComponentTopology> wanted =
            count_manifold(parsed(padded(samples, -1000000), false, {1, 1, 1}, options)).components;
        std::ranges::sort(found);
        std::ranges::sort(wanted);
        ASSERT_EQ(found, wanted) << seed;
      }
    }
  }
}

TEST(ComponentSizes, EveryComponentHasAPart) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const Samples samples = random_samples(Family::white_noise, {7, 6, 8}, seed);
    for (const Interpolation interpolation : {Interpolation::trilinear, Interpolation::tricubic}) {
      for (const std::uint32_t supersample : {1U, 2U}) {
        ParseOptions options;
        options.interpolation = interpolation;
        options.supersample = supersample;
        const SurfaceComplex open = parsed(samples, false, {1, 1, 1}, options);
        const SurfaceComplex closed = parsed(samples, true, {1, 1, 1}, options);
        const ComponentSizes sizes =
            component_sizes(open, find_components(open), closed, find_components(closed));
        for (const std::uint32_t part : sizes.part_of) {
          ASSERT_LT(part, sizes.enclosed.size()) << seed;
          ASSERT_GT(sizes.enclosed[part], 0) << seed;
          ASSERT_LE(sizes.enclosed[part], 6 * 5 * 7 + 1e-9) << seed;
        }
      }
    }
  }
}

}  // namespace
}  // namespace isoatlas::detail
