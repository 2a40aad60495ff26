// SPDX-License-Identifier: Apache-2.0
// Input that extract() refuses and the error messages; progress and cancellation; samples that are
// not finite.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <thread>

#include "isoatlas/error.h"
#include "isoatlas/extract.h"
#include "support/reference_topology.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

void expect_error(ErrorCode code, const std::vector<std::string>& words, const VolumeView& volume,
                  const ExtractOptions& options, const RunControl& control = {}) {
  try {
    extract(volume, options, control);
    FAIL() << "no error; expected one that contains " << (words.empty() ? "" : words[0]);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code) << e.what();
    for (const std::string& word : words)
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << "messages are one line";
  }
}

Volume ball() { return to_volume(sampled({12, 12, 12}, sphere({5.4, 5.6, 5.55}, 4))); }

TEST(Refuses, OneSampleAlongAnAxis) {
  for (int axis = 0; axis < 3; ++axis) {
    Size size{4, 4, 4};
    size[axis] = 1;
    expect_error(ErrorCode::bad_argument, {"1 sample", std::string(1, "xyz"[axis])},
                 to_volume(constant(size, 0)), {});
  }
}

TEST(Refuses, MoreSamplesThanAnyMemoryHolds) {
  Volume volume = ball();
  const std::size_t large = std::size_t{1} << 31;
  volume.view.grid.size = {large, large, large};  // the product overflows 64 bits and becomes 0
  expect_error(ErrorCode::bad_argument, {"2147483648 x 2147483648", "larger than any memory"},
               volume, {});
}

TEST(Refuses, BadSpacing) {
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (int axis = 0; axis < 3; ++axis) {
      Volume volume = ball();
      (axis == 0   ? volume.view.grid.spacing.x
       : axis == 1 ? volume.view.grid.spacing.y
                   : volume.view.grid.spacing.z) = bad;
      expect_error(ErrorCode::bad_argument, {"spacing"}, volume, {});
    }
  }
}

TEST(Refuses, NonFiniteIsovalueAndBadLengths) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()}) {
    ExtractOptions o = coarse_options();
    o.surface.isovalue = bad;
    expect_error(ErrorCode::bad_argument, {"isovalue"}, ball(), o);
    o = {};
    o.supersample = 0;
    expect_error(ErrorCode::bad_argument, {"supersampling"}, ball(), o);
    o.supersample = 1u << 31;
    expect_error(ErrorCode::bad_argument, {"12 x 12 x 12", "too many"}, ball(), o);
    o = {};
    o.adaptive_supersample = 9;
    expect_error(ErrorCode::bad_argument, {"adaptive supersampling", "8"}, ball(), o);
    o = {};
    o.covering.max_radius = bad;
    expect_error(ErrorCode::bad_argument, {"radius"}, ball(), o);
    o = {};
    o.covering.event_persistence = bad;
    expect_error(ErrorCode::bad_argument, {"persistence"}, ball(), o);
  }
  ExtractOptions o = coarse_options();
  o.covering.max_radius = 0;
  expect_error(ErrorCode::bad_argument, {"radius"}, ball(), o);
  o = {};
  o.covering.event_persistence = -0.1;
  expect_error(ErrorCode::bad_argument, {"persistence"}, ball(), o);
}

TEST(Refuses, NoSurfaceAndReportsTheRange) {
  Samples s = constant({4, 4, 4}, 17);
  s.at(1, 1, 1) = -40;
  s.at(2, 1, 1) = 1234;
  for (const double isovalue : {1234.5, -41.0, 1e300, -1e300}) {
    ExtractOptions o = coarse_options();
    o.surface.isovalue = isovalue;
    expect_error(ErrorCode::empty_surface, {"-40", "1234"}, to_volume(s), o);
  }
  ExtractOptions below = coarse_options();
  below.surface.inside = Inside::below;
  below.surface.isovalue = 1234;  // a sample equal to the isovalue is inside either way, so all are
  expect_error(ErrorCode::empty_surface, {"1234"}, to_volume(s), below);
  below.surface.isovalue = -40;
  EXPECT_NO_THROW(extract(to_volume(s), below));
  ExtractOptions above = coarse_options();
  above.surface.isovalue = -40;
  expect_error(ErrorCode::empty_surface, {"-40"}, to_volume(s), above);
  above.surface.isovalue = 1234;
  EXPECT_NO_THROW(extract(to_volume(s), above));
}

Volume with_nan() {
  Grid grid;
  grid.size = {8, 8, 8};
  std::vector<float> values;
  const Samples s = sampled({8, 8, 8}, sphere({3.4, 3.6, 3.55}, 2.5));
  for (const std::int64_t v : s.values) values.push_back(static_cast<float>(v));
  values[3 + 8 * (4 + 8 * 3)] = std::nanf("");
  return own(grid, SampleType::float32, std::move(values));
}

TEST(Refuses, InvalidGrids) {
  Volume volume = ball();
  const VolumeView good = volume;
  VolumeView bad = good;
  bad.grid.spacing.z = 1e7;
  expect_error(ErrorCode::bad_argument, {"factor"}, bad, {});
  bad = good;
  bad.grid.origin.y = std::nan("");
  expect_error(ErrorCode::bad_argument, {"origin"}, bad, {});
  bad = good;
  bad.grid.direction[1] = bad.grid.direction[0];
  expect_error(ErrorCode::bad_argument, {"direction"}, bad, {});
  bad = good;
  bad.grid.spacing = {1e308, 1e308, 1e308};  // found by fuzzing: vertices at infinity
  expect_error(ErrorCode::bad_argument, {"beyond the range"}, bad, {});
  bad = good;
  bad.grid.origin.z = 1e300;  // found by fuzzing: all vertices at one point
  expect_error(ErrorCode::bad_argument, {"along z", "too small"}, bad, {});
  bad = good;
  bad.grid.spacing = {5e-324, 5e-324, 5e-324};
  expect_error(ErrorCode::bad_argument, {"along x", "too small"}, bad, {});
  bad.grid.spacing = {1e-6, 1, 1};
  bad.grid.origin = {0, 0, 1e9};
  EXPECT_NO_THROW(extract(bad, {})) << "only numbers along z are far apart";
  bad = good;
  bad.samples = nullptr;
  expect_error(ErrorCode::bad_argument, {"no samples"}, bad, {});
  bad = good;
  bad.type = static_cast<SampleType>(99);
  expect_error(ErrorCode::bad_argument, {"type"}, bad, {});
}

// A ball of volume 1437 above a slab of 770 that the volume boundary cuts into two sheets, each
// with more area than the ball.
TEST(Components, ABallIsLargerThanASlabThatTheVolumeBoundaryCuts) {
  Samples samples = sampled({20, 20, 40}, sphere({9.5, 9.5, 12}, 7));
  for (std::size_t i = 0; i < 20 * 20 * 3; ++i)
    samples.at(i % 20, i / 20 % 20, 30 + i / 400) = 1000;
  ExtractOptions options = coarse_options();
  options.components.keep_largest = 1;
  const Extraction e = extract(to_volume(samples), options);
  ASSERT_EQ(e.report.kept.size(), 1u);
  EXPECT_EQ(e.report.kept[0].topology, (ComponentTopology{2, 0}));
  EXPECT_EQ(e.report.kept[0].part, 0u);
  ASSERT_EQ(e.report.dropped.size(), 2u);
  EXPECT_EQ(e.report.dropped[0].size, e.report.dropped[1].size) << "both sides of one slab";
  EXPECT_EQ(e.report.dropped[0].part, 1u);
  EXPECT_EQ(e.report.dropped[1].part, 1u);
  EXPECT_NEAR(e.report.dropped[0].size, 19 * 19 * 2.14, 10)
      << "samples 3 deep, nodes nearer to them than to those outside";
  options.components.keep_largest = 2;
  EXPECT_TRUE(extract(to_volume(samples), options).report.dropped.empty());
}

// Balls of radius 6, 3 and 1.5, spacing 2: volumes 7238, 905 and 113.
TEST(Components, SmallOnesAreDroppedAndListed) {
  const Function balls = unite(unite(sphere({8.3, 8.4, 8.6}, 6), sphere({20.4, 8.5, 8.3}, 3)),
                               sphere({28.4, 8.5, 8.3}, 1.5));
  const Volume volume = to_volume(sampled({32, 18, 18}, balls), SampleType::int32, {2, 2, 2});
  const auto left = [&](double smallest, std::size_t keep) {
    ExtractOptions options = coarse_options();
    options.components.min_size = smallest;
    options.components.keep_largest = keep;
    options.refine = {{{Quantity::max_distance, 1}}};
    const Extraction e = extract(volume, options);
    EXPECT_EQ(e.report.reference.components + e.report.dropped.size(), 3u);
    EXPECT_EQ(count_manifold(e.mesh()).topology, e.report.reference);
    for (std::size_t k = 1; k < e.report.dropped.size(); ++k)
      EXPECT_GE(e.report.dropped[k - 1].size, e.report.dropped[k].size);
    return e.report;
  };
  EXPECT_EQ(left(0, 0).reference.components, 3u);
  EXPECT_EQ(left(200, 0).reference.components, 2u);
  EXPECT_EQ(left(2000, 0).reference.components, 1u);
  EXPECT_EQ(left(0, 2).reference.components, 2u);
  EXPECT_EQ(left(0, 7).reference.components, 3u);
  EXPECT_EQ(left(2000, 2).reference.components, 1u) << "both";
  const ExtractReport report = left(0, 1);
  ASSERT_EQ(report.dropped.size(), 2u);
  EXPECT_NEAR(report.dropped[0].size, 905, 110);
  EXPECT_NEAR(report.dropped[0].position.x, 2 * 20.4, 2 * 4.0);
  EXPECT_EQ(report.dropped[0].topology, (ComponentTopology{2, 0}));
  EXPECT_GT(report.dropped[0].c_vertices, report.dropped[1].c_vertices);

  ASSERT_EQ(report.kept.size(), 1u);
  EXPECT_NEAR(report.kept[0].size, 7238, 300);
  EXPECT_EQ(report.kept[0].c_vertices, report.c_vertices);
  EXPECT_TRUE(left(0, 0).kept.empty()) << "sizes were not requested";

  ExtractOptions all = coarse_options();
  all.components.min_size = 1e5;
  expect_error(ErrorCode::empty_surface, {"every component is dropped", "the largest"}, volume,
               all);
  for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    all.components.min_size = bad;
    expect_error(ErrorCode::bad_argument, {"smallest component"}, volume, all);
  }
}

// The same balls; points are in the coordinates of the mesh, and need not be on a ball.
TEST(Components, AreKeptAndDroppedNearPoints) {
  const Function balls = unite(unite(sphere({8.3, 8.4, 8.6}, 6), sphere({20.4, 8.5, 8.3}, 3)),
                               sphere({28.4, 8.5, 8.3}, 1.5));
  const Volume volume = to_volume(sampled({32, 18, 18}, balls), SampleType::int32, {2, 2, 2});
  const Vec3 large{16, 16, 16}, middle{41, 25, 16}, small{60, 17, 17};  // world coordinates
  using Points = std::vector<Vec3>;
  const auto kept_sizes = [&](const Points& keep, const Points& drop, Space space,
                              std::size_t keep_largest = 0) {
    ExtractOptions options = coarse_options();
    options.components = {.keep_largest = keep_largest, .keep_near = keep, .drop_near = drop};
    options.space = space;
    const Extraction e = extract(volume, options);
    EXPECT_EQ(e.report.kept.size() + e.report.dropped.size(), 3u);
    EXPECT_EQ(count_manifold(e.mesh()).components.size(), e.report.kept.size());
    std::vector<int> out;
    for (const RankedComponent& c : e.report.kept)
      out.push_back(static_cast<int>(std::lround(std::log10(c.size))));
    return out;
  };
  using Sizes = std::vector<int>;
  EXPECT_EQ(kept_sizes({middle}, {}, Space::lps), (Sizes{3}));
  EXPECT_EQ(kept_sizes({small, large, large}, {}, Space::lps), (Sizes{4, 2}));
  EXPECT_EQ(kept_sizes({}, {middle}, Space::lps), (Sizes{4, 2}));
  EXPECT_EQ(kept_sizes({large, middle}, {middle}, Space::lps), (Sizes{4}));
  EXPECT_EQ(kept_sizes({}, {large}, Space::lps, 2), (Sizes{3})) << "of the two largest";
  EXPECT_EQ(kept_sizes({{-41, -25, 16}}, {}, Space::ras), (Sizes{3}));
  EXPECT_EQ(kept_sizes({{28, 8, 8}}, {}, Space::voxel), (Sizes{2}));
  ExtractOptions none = coarse_options();
  none.components.keep_near = none.components.drop_near = {large};
  expect_error(ErrorCode::empty_surface, {"every component is dropped"}, volume, none);
}

// What the cap connects is one part.
TEST(Components, NearAPointAreKeptTogetherWithTheirPart) {
  Samples samples = sampled({20, 20, 40}, sphere({9.5, 9.5, 12}, 7));
  for (std::size_t i = 0; i < 20 * 20 * 3; ++i)
    samples.at(i % 20, i / 20 % 20, 30 + i / 400) = 1000;
  ExtractOptions options = coarse_options();
  options.components.keep_near = {{9, 9, 34}};
  const Extraction e = extract(to_volume(samples), options);
  EXPECT_EQ(e.report.kept.size(), 2u) << "both sides of the slab";
  EXPECT_EQ(e.report.dropped.size(), 1u);
}

// Lengths use the spacing, which on a sheared grid does not give world lengths.
TEST(Refuses, ToRefineOrMeasureOnAShearedGrid) {
  Volume volume = ball();
  volume.view.grid.direction[1] = {std::sqrt(0.5), std::sqrt(0.5), 0};
  ExtractOptions refine, coarse, measure;
  refine.refine = {{{Quantity::max_distance, 1}}};
  coarse.coarse = {{Quantity::max_vertices, 100}};
  measure.measure_samples = 10;
  for (const ExtractOptions& options : {refine, coarse, measure})
    expect_error(ErrorCode::unsupported,
                 {"sheared", "x and y axes are at 45 degrees", "ExtractOptions::refine"}, volume,
                 options);
  EXPECT_NO_THROW(extract(volume, coarse_options()));
  volume.view.grid.direction[1] = {0, 2, 0};
  expect_error(ErrorCode::unsupported, {"y axis has length 2"}, volume, refine);
  volume.view.grid.direction[1] = {5e-4, 1, 0};  // as rounded in some headers
  EXPECT_NO_THROW(extract(volume, refine));
}

TEST(NonFinite, RefusedWithCountAndPlace) {
  expect_error(ErrorCode::unsupported, {"1 NaN", "(3, 4, 3)", "SurfaceOptions::non_finite"},
               with_nan(), {});
}

TEST(NonFinite, OnTheChosenSide) {
  ExtractOptions o = coarse_options();
  o.surface.non_finite = NonFinite::above;
  EXPECT_EQ(kinds_of(extract(with_nan(), o).mesh()),
            (std::vector<TopologySummary::Kind>{{0, 0, 1}}));
  o.surface.non_finite = NonFinite::below;  // now a cavity in the ball
  EXPECT_EQ(kinds_of(extract(with_nan(), o).mesh()),
            (std::vector<TopologySummary::Kind>{{0, 0, 2}}));
  o.surface.inside = Inside::below;
  EXPECT_EQ(kinds_of(extract(with_nan(), o).mesh()),
            (std::vector<TopologySummary::Kind>{{0, 0, 2}}));
}

TEST(NonFinite, InfinitiesKeepTheirSide) {
  Grid grid;
  grid.size = {5, 5, 5};
  for (const double sign : {1.0, -1.0}) {
    std::vector<double> values(125, -sign);
    values[62] = sign * std::numeric_limits<double>::infinity();
    for (const NonFinite policy : {NonFinite::above, NonFinite::below}) {
      ExtractOptions o = coarse_options();
      o.surface.non_finite = policy;
      const Extraction e = extract(own(grid, SampleType::float64, values), o);
      EXPECT_EQ(kinds_of(e.mesh()), (std::vector<TopologySummary::Kind>{{0, 0, 1}}));
      EXPECT_EQ(signed_volume(e.mesh()) > 0, sign > 0);
    }
  }
}

TEST(NonFinite, NothingFinite) {
  Grid grid;
  grid.size = {3, 3, 3};
  ExtractOptions o = coarse_options();
  o.surface.non_finite = NonFinite::above;
  expect_error(ErrorCode::empty_surface, {"finite"},
               own(grid, SampleType::float32, std::vector<float>(27, std::nanf(""))), o);
}

// Noise of NaN, infinities and numbers: the mesh equals that of a volume of plain signs wherever no
// face is ambiguous, and is always a certified manifold.
TEST(NonFinite, NoiseOfEverything) {
  Random random(5);
  const double inf = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 20; ++round) {
    Grid grid;
    grid.size = {7, 6, 5};
    std::vector<double> values(210);
    for (double& v : values) {
      const auto kind = random.bits() % 6;
      v = kind == 0 ? std::nan("") : kind == 1 ? inf : kind == 2 ? -inf : random.unit() - 0.5;
    }
    for (const NonFinite policy : {NonFinite::above, NonFinite::below}) {
      for (const Inside inside : {Inside::above, Inside::below}) {
        ExtractOptions o = coarse_options();
        o.surface.non_finite = policy;
        o.surface.inside = inside;
        const Extraction e = extract(own(grid, SampleType::float64, values), o);
        EXPECT_EQ(kinds_of(e.mesh()), e.report.reference.kinds);
        for (const Vec3& p : e.mesh().positions) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
      }
    }
  }
}

// ------------------------------------------------------------------------------------------
// extreme magnitudes and spacing

Extraction scaled_torus(double scale, double spacing) {
  const Samples s = sampled({12, 12, 12}, torus({5.4, 5.6, 5.55}, 3.2, 1.6));
  Grid grid;
  grid.size = s.size;
  grid.spacing = {spacing, spacing, spacing};
  std::vector<double> values;
  for (const std::int64_t v : s.values) values.push_back(static_cast<double>(v) * scale);
  return extract(own(grid, SampleType::float64, values), {});
}

TEST(Extremes, HugeAndTinySamplesAndSpacings) {
  const std::size_t triangles = scaled_torus(1, 1).mesh().triangles.size();
  for (const double scale : {1e300, 1e200, 1e-200, 1e-300, 1e-320}) {
    for (const double spacing : {1e-6, 1.0, 1e6}) {
      const Extraction e = scaled_torus(scale, spacing);
      EXPECT_EQ(kinds_of(e.mesh()), (std::vector<TopologySummary::Kind>{{1, 0, 1}}))
          << scale << " " << spacing;
      EXPECT_EQ(e.finest().inverted_components, 0u) << scale << " " << spacing;
      EXPECT_LE(e.mesh().triangles.size(), 2 * triangles)
          << "as coarse as ever, " << scale << " " << spacing;
      for (const Vec3& p : e.mesh().positions) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
      const auto [low, high] = bounding_box(e.mesh());
      EXPECT_GT(high.x - low.x, 5 * spacing);
      EXPECT_GT(signed_volume(e.mesh()), 0);
    }
  }
}

// The unit of length is the smallest spacing: if a length left the range of float, the covering
// would never end.
TEST(Extremes, UnitsOfLengthDoNotMatter) {
  const Extraction one = scaled_torus(1, 1);
  for (const double spacing : {0x1p-600, 0x1p-160, 0x1p-40, 0x1p40, 0x1p160, 0x1p600}) {
    EXPECT_EQ(scaled_torus(1, spacing).mesh().triangles, one.mesh().triangles) << spacing;
  }
}

TEST(Extremes, RadiusAndPersistenceOfAnyLength) {
  const Volume volume = ball();
  for (const double length : {1e-300, 1e-60, 1e-9, 1e9, 1e60, 1e300}) {
    ExtractOptions radius, persistence;
    radius.covering.max_radius = length;
    persistence.covering.event_persistence = length;
    ExtractOptions halving = radius;
    halving.covering.strategy = CoveringStrategy::halving;
    for (const ExtractOptions& options : {radius, persistence, halving}) {
      const Extraction e = extract(volume, options);
      EXPECT_EQ(kinds_of(e.mesh()), (std::vector<TopologySummary::Kind>{{0, 0, 1}})) << length;
    }
  }
}

// A large persistence must not make every disk swallow the surface, which once took minutes.
TEST(Extremes, LargePersistenceCostsNoMore) {
  const Volume volume = to_volume(sampled({64, 64, 64}, sphere({31.4, 31.6, 31.55}, 28)));
  ExtractOptions options = coarse_options();
  options.covering.max_radius = 1;
  options.covering.event_persistence = 1000;
  const Extraction e = extract(volume, options);
  EXPECT_GT(e.mesh().triangles.size(), 4000u);
}

// A power of two changes no digit of any sample, so the result is the same.
TEST(Extremes, UnitsOfTheSamplesDoNotMatter) {
  const Extraction one = scaled_torus(1, 1);
  for (const double scale : {0x1p-400, 0x1p-60, 0x1p60, 0x1p400}) {
    const Extraction e = scaled_torus(scale, 1);
    EXPECT_EQ(e.mesh().triangles, one.mesh().triangles) << scale;
    EXPECT_EQ(e.mesh().positions, one.mesh().positions) << scale;
  }
}

// A power of two in the spacing only scales all lengths.
TEST(Extremes, UnitsOfTheWorldDoNotMatter) {
  const Extraction one = scaled_torus(1, 1);
  for (const double spacing : {0x1p-20, 0x1p-3, 4.0, 0x1p20}) {
    const Extraction e = scaled_torus(1, spacing);
    ASSERT_EQ(e.mesh().triangles, one.mesh().triangles) << spacing;
    for (std::size_t i = 0; i < one.mesh().positions.size(); ++i) {
      const Vec3 p = one.mesh().positions[i];
      ASSERT_EQ(e.mesh().positions[i], (Vec3{p.x * spacing, p.y * spacing, p.z * spacing}))
          << spacing;
    }
  }
}

TEST(Extremes, VeryDifferentSpacingsAlongTheAxes) {
  const Samples s = sampled({14, 14, 14}, gyroid(7.7, 0.1));
  const auto kinds = reference_topology(s, 0).kinds;
  for (const Vec3 spacing : {Vec3{1, 1, 100}, Vec3{0.01, 1, 1}, Vec3{1, 30, 0.5}}) {
    EXPECT_EQ(kinds_of(extract(to_volume(s, SampleType::int32, spacing), {}).mesh()), kinds);
  }
}

TEST(Extremes, EveryRadiusAndPersistenceIsCertified) {
  const Samples s = random_samples(Family::gyroid_cut, {12, 13, 11}, 4);
  const auto kinds = reference_topology(s, 0).kinds;
  for (const double radius : {1e-3, 1.0, 5.0, 1e6}) {
    for (const double persistence : {0.0, 1.5, 1e6}) {
      ExtractOptions o = coarse_options();
      o.covering.max_radius = radius;
      o.covering.event_persistence = persistence;
      EXPECT_EQ(kinds_of(extract(to_volume(s), o).mesh()), kinds) << radius << " " << persistence;
      o.covering.strategy = CoveringStrategy::halving;
      EXPECT_EQ(kinds_of(extract(to_volume(s), o).mesh()), kinds)
          << radius << " " << persistence << ", halving";
    }
  }
  ExtractOptions plain = coarse_options();
  plain.vertices_on_surface = false;
  EXPECT_EQ(kinds_of(extract(to_volume(s), plain).mesh()), kinds);
}

// ------------------------------------------------------------------------------------------------
// progress, cancellation

TEST(Control, ProgressIsReportedStageByStageWithFractions) {
  RunControl control;
  std::vector<std::string> stages;
  std::map<std::string, double> last;
  control.progress = [&](std::string_view stage, double fraction) {
    EXPECT_GE(fraction, 0);
    EXPECT_LE(fraction, 1);
    const std::string title(stage);
    EXPECT_FALSE(title.empty());
    if (stages.empty() || stages.back() != title) stages.push_back(title);
    EXPECT_GE(fraction, last[title]) << title << " goes backwards";
    last[title] = fraction;
  };
  extract(to_volume(random_samples(Family::white_noise, {16, 16, 16}, 2)), {}, control);
  EXPECT_GE(stages.size(), 3u);
  EXPECT_EQ(last.size(), stages.size()) << "a stage is not left and entered again";
}

TEST(Control, CancelledBeforeTheStart) {
  const std::atomic<bool> cancel{true};
  RunControl control;
  control.cancel = &cancel;
  expect_error(ErrorCode::cancelled, {}, ball(), {}, control);
}

TEST(Control, CancelledInEveryStage) {
  const Volume volume = to_volume(random_samples(Family::white_noise, {14, 14, 14}, 2));
  std::vector<std::string> stages;
  RunControl observed;
  observed.progress = [&](std::string_view stage, double) {
    if (stages.empty() || stages.back() != stage) stages.emplace_back(stage);
  };
  extract(volume, {}, observed);
  for (const std::string& stop : stages) {
    if (stop == stages.back()) continue;  // the last stage may end before it tests for cancellation
    std::atomic<bool> cancel{false};
    RunControl control;
    control.cancel = &cancel;
    control.progress = [&](std::string_view stage, double) {
      if (stage == stop) cancel = true;
    };
    expect_error(ErrorCode::cancelled, {}, volume, {}, control);
  }
}

TEST(Control, TimesAddUp) {
  const Extraction e = extract(ball(), {});
  double sum = 0;
  for (const StageTime& t : e.report.seconds) {
    EXPECT_GE(t.seconds, 0) << t.stage;
    sum += t.seconds;
  }
  EXPECT_LE(sum, e.report.total_seconds * 1.01 + 1e-6);
  EXPECT_GE(e.report.seconds.size(), 3u);
}

}  // namespace
}  // namespace isoatlas::detail
