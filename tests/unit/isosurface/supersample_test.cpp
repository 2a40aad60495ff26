// SPDX-License-Identifier: Apache-2.0
// Parsing with upsampled samples against parsing the whole volume upsampled.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/vector_math.h"
#include "field/sample_type.h"
#include "isosurface/parse_surface.h"
#include "support/reference_topology.h"
#include "support/surfaces.h"
#include "support/upsampled.h"

namespace isoatlas::detail {
namespace {

using namespace test;

struct Case {
  Volume volume;
  ParseOptions options;
};

Case random_case(std::uint64_t seed, Interpolation interpolation) {
  const auto family = static_cast<Family>(seed % kFamilies);
  const Samples samples = random_samples(family, {2 + seed % 6, 5, 2 + seed % 4}, seed);
  constexpr SampleType kTypes[] = {SampleType::int16, SampleType::float32, SampleType::float64,
                                   SampleType::int64};
  Case out{
      to_volume(samples, kTypes[seed / 3 % 4], {1, 1 + 0.5 * static_cast<double>(seed % 2), 2}),
      {}};
  out.options.rule = {seed % 5 == 0 ? 0.0 : 0.3, seed % 2 == 0 ? Inside::above : Inside::below,
                      NonFinite::refuse};
  out.options.topology = seed % 3 == 0 ? Topology::trilinear : Topology::faces;
  out.options.interpolation = interpolation;
  out.options.supersample = static_cast<std::uint32_t>(2 + seed % 4);
  return out;
}

void expect_same_faces(const SurfaceComplex& a, const SurfaceComplex& b, std::uint64_t seed) {
  ASSERT_EQ(validate(a), "") << seed;
  ASSERT_EQ(kinds_of(triangles_of(a)), kinds_of(triangles_of(b))) << seed;
  ASSERT_EQ(a.positions.size(), b.positions.size()) << seed;
  ASSERT_EQ(a.on_boundary, b.on_boundary) << seed;
  ASSERT_EQ(a.faces.size(), b.faces.size()) << seed;
  for (std::size_t i = 0; i < a.faces.size(); ++i)
    ASSERT_EQ(a.faces[i].corner, b.faces[i].corner) << seed;
  ASSERT_EQ(a.tunnels, b.tunnels) << seed;
  ASSERT_EQ(a.double_segments, b.double_segments) << seed;
}

TEST(Supersample, TrilinearEqualsTheUpsampledVolume) {
  std::size_t parsed = 0;
  for (std::uint64_t seed = 0; seed < 160; ++seed) {
    const Case c = random_case(seed, Interpolation::trilinear);
    const SurfaceComplex fine = parse_surface(c.volume, c.options);
    ParseOptions plain = c.options;
    plain.supersample = 1;
    const SurfaceComplex whole =
        parse_surface(upsampled(c.volume, c.options.interpolation, c.options.supersample), plain);
    expect_same_faces(fine, whole, seed);
    if (HasFatalFailure()) return;
    if (fine.faces.empty()) continue;
    ++parsed;
    ASSERT_LT(length(static_cast<double>(c.options.supersample) * fine.spacing -
                     c.volume.view.grid.spacing),
              1e-12)
        << seed;
    for (std::size_t v = 0; v < fine.positions.size(); ++v) {
      ASSERT_LT(length(fine.positions[v] - whole.positions[v]), 1e-9) << seed;
    }
  }
  EXPECT_GT(parsed, 100u);
}

// The topology is that of the whole volume upsampled; points are on the spline itself, in the same
// grid cells, and boundaries on the volume boundary.
TEST(Supersample, TricubicEqualsTheUpsampledVolume) {
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    const Case c = random_case(seed, Interpolation::tricubic);
    const SurfaceComplex fine = parse_surface(c.volume, c.options);
    ParseOptions plain = c.options;
    plain.supersample = 1;
    const SurfaceComplex whole =
        parse_surface(upsampled(c.volume, c.options.interpolation, c.options.supersample), plain);
    expect_same_faces(fine, whole, seed);
    if (HasFatalFailure()) return;
    for (CVertexId v = 0; v < fine.c_vertex_count(); ++v) {
      const Vec3 p = fine.positions[v], q = whole.positions[v];
      const auto same_cell = [](double a, double b) {
        return std::floor(a) == std::floor(b) && std::ceil(a) == std::ceil(b);
      };
      ASSERT_TRUE(same_cell(p.x, q.x) && same_cell(p.y, q.y) && same_cell(p.z, q.z)) << seed;
    }
  }
}

TEST(Supersample, TricubicPointsAreOnTheVolumesSpline) {
  const Volume volume = to_volume(sampled({22, 23, 24}, sphere({10.6, 11.3, 11.45}, 7), 1000));
  ParseOptions options;
  options.interpolation = Interpolation::tricubic;
  double worst = 1;
  for (const std::uint32_t factor : {1u, 2u, 4u}) {
    options.supersample = factor;
    const InterpolatedField field(volume, options.rule, Interpolation::tricubic, factor);
    const SurfaceComplex surface = parse_surface(volume, options);
    double mean = 0;
    for (const Vec3& p : surface.positions) {
      const InterpolatedField::Value at = field.at(p);
      mean += std::abs(at.value) / length(at.gradient) / surface.c_vertex_count();
    }
    EXPECT_LT(mean, worst / 4) << factor;
    worst = mean;
  }
  EXPECT_LT(worst, 1e-4);
}

// A neck that only the spline has: samples in a checkerboard of two values, all outside, between
// which it overshoots.
TEST(Supersample, FindsANeckBetweenOutsideSamples) {
  const Volume volume = to_volume(sampled(
      {6, 6, 6},
      [](double x, double y, double z) {
        const auto middle = [](double a) { return a == 2 || a == 3; };
        return middle(x) && middle(y) && middle(z) ? 10.0 : 0.0;
      },
      1));
  ParseOptions options;
  options.rule.isovalue = 10.5;
  options.interpolation = Interpolation::tricubic;
  EXPECT_TRUE(parse_surface(volume, options).faces.empty());
  options.supersample = 4;
  const SurfaceComplex surface = parse_surface(volume, options);
  EXPECT_EQ(validate(surface), "");
  EXPECT_EQ(text(kinds_of(triangles_of(surface))), text({{0, 0, 1}}));
  options.interpolation = Interpolation::trilinear;
  EXPECT_TRUE(parse_surface(volume, options).faces.empty());
}

}  // namespace
}  // namespace isoatlas::detail
