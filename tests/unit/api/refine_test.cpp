// SPDX-License-Identifier: Apache-2.0
// Levels through extract(): bounds are satisfied, and extreme goals are handled.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>

#include "isoatlas/error.h"
#include "isoatlas/extract.h"
#include "support/exact_volume.h"
#include "support/mesh_counts.h"
#include "support/reference_topology.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

ExtractOptions options_with(std::vector<LevelGoal> levels,
                            Placement placement = Placement::surface) {
  ExtractOptions out = coarse_options();
  out.refine = std::move(levels);
  out.placement = placement;
  return out;
}

Volume ball(double radius = 9) {
  const double c = radius + 2.45;
  const auto n = static_cast<std::size_t>(2 * radius + 6);
  return exact_volume({n, n, n}, sphere({c, c + 0.1, c + 0.05}, radius));
}

const ConstraintResult& result_of(const LevelReport& level, Quantity quantity) {
  const auto it = std::find_if(level.constraints.begin(), level.constraints.end(),
                               [&](const auto& r) { return r.constraint.quantity == quantity; });
  if (it == level.constraints.end()) throw std::runtime_error("no such constraint");
  return *it;
}

// Every level is a manifold with the reference's topology and has finite figures.
void expect_sound(const Extraction& e, const std::string& what) {
  for (std::size_t l = 0; l < e.hierarchy.levels.size(); ++l) {
    const TriangleMesh mesh = e.hierarchy.mesh(l);
    const MeshCounts counts = count_mesh(mesh);
    ASSERT_EQ(counts.fault, "") << what << ", level " << l;
    ASSERT_EQ(counts.topology, e.report.reference) << what << ", level " << l;
    ASSERT_TRUE(e.report.levels[l].certificate.passed);
    const std::vector<float>& distance = e.hierarchy.levels[l].distance;
    ASSERT_EQ(distance.size(), mesh.positions.size()) << what << ", level " << l;
    ASSERT_EQ(*std::max_element(distance.begin(), distance.end()),
              static_cast<float>((*e.report.levels[l].metrics)[0].maximum))
        << what << ", level " << l;
    for (const ConstraintResult& r : e.report.levels[l].constraints)
      ASSERT_EQ(r.satisfied, r.reason.empty()) << what << ": " << r.reason;
  }
}

// -------------------------------------------------------------------------------------------------
// bounds

struct Shape {
  std::string name;
  Volume volume;
};

std::vector<Shape> shapes() {
  std::vector<Shape> out;
  out.push_back({"ball", ball(14)});
  out.push_back({"torus", exact_volume({44, 44, 22}, torus({21.4, 21.6, 10.55}, 14, 5.5))});
  const Function cells = gyroid(16, 0.1);
  out.push_back({"gyroid", exact_volume({28, 26, 27}, [=](double x, double y, double z) {
                   return 1000 * cells(x, y, z);
                 })});
  out.push_back({"ellipsoid in an anisotropic grid",
                 exact_volume({40, 24, 30},
                              [](double x, double y, double z) {
                                return 8 - std::hypot((x - 19.4) * 0.5, (y - 11.6) * 1.0,
                                                      (z - 14.55) * 0.7);
                              },
                              {0.5, 1, 0.7})});
  return out;
}

// The bound holds at samples the mesher chose; between them the distance may be up to a quarter
// larger.
TEST(Bounds, OnTheDistanceHoldTwoSidedInNestedLevels) {
  for (const Shape& shape : shapes()) {
    const double voxel = shape.volume.view.grid.smallest_spacing();
    std::vector<LevelGoal> levels;
    for (const double bound : {2.0, 1.0, 0.5, 0.25})
      levels.push_back({{Quantity::max_distance, bound * voxel}});
    for (const Placement placement : {Placement::surface, Placement::balanced}) {
      const std::string what =
          shape.name + (placement == Placement::surface ? ", surface" : ", balanced");
      const Extraction e = extract(shape.volume, options_with(levels, placement));
      expect_sound(e, what);
      if (HasFatalFailure()) return;
      MeasureOptions options;
      options.samples = 40'000;
      for (std::size_t l = 0; l < levels.size(); ++l) {
        const LevelReport& report = e.report.levels[l + 1];
        const double bound = levels[l].front().bound;
        EXPECT_TRUE(report.all_satisfied()) << what << ": " << report.constraints.front().reason;
        EXPECT_LE((*report.metrics)[0].maximum, bound);
        EXPECT_LE(measure(e.hierarchy.mesh(l + 1), shape.volume, options).maximum(), 1.25 * bound)
            << what << ", bound " << bound;
        EXPECT_GE(report.vertices, e.report.levels[l].vertices);
      }
    }
  }
}

TEST(Bounds, OnEveryMetricAreSatisfied) {
  const Volume volume = ball();
  for (const Constraint& c :
       {Constraint{Quantity::max_distance, 0.3}, Constraint{Quantity::mean_distance, 0.1},
        Constraint{Quantity::area_curvature, 1.02},
        Constraint{Quantity::area_curvature_smooth, 1.01},
        Constraint{Quantity::geodesic_ratio, 1.02}, Constraint{Quantity::normal_angle, 30},
        Constraint{Quantity::max_edge, 4}, Constraint{Quantity::min_vertices, 150}}) {
    for (const Placement placement : {Placement::surface, Placement::balanced}) {
      const Extraction e = extract(volume, options_with({{c}}, placement));
      expect_sound(e, std::string(name(c.quantity)));
      if (HasFatalFailure()) return;
      EXPECT_TRUE(e.finest().all_satisfied())
          << name(c.quantity) << " " << e.finest().constraints[0].reached << ": "
          << e.finest().constraints[0].reason;
      EXPECT_LT(e.finest().vertices, e.report.c_vertices / 2)
          << name(c.quantity) << ": no more than that";
    }
  }
}

// Where cells are as small as possible, smaller ones are not better. A bound never gives a larger
// distance than the looser bounds that are tried for it; other bounds may, by chance, but not by
// much.
TEST(Bounds, TighterOnesGiveNoLargerDistance) {
  if (!is_thorough()) GTEST_SKIP() << kThoroughOnly;
  for (const Family family : {Family::gyroid_cut, Family::white_noise}) {
    for (const std::uint64_t seed : {1U, 3U}) {
      SCOPED_TRACE(seed);
      const Volume volume = to_volume(random_samples(family, {10, 12, 11}, seed));
      double before = 2, tried = std::numeric_limits<double>::infinity();
      for (const double bound : {0.5, 0.45, 0.4, 0.35, 0.32, 0.256, 0.2, 0.01}) {
        const Extraction e = extract(volume, options_with({{{Quantity::max_distance, bound}}}));
        const ConstraintResult& result = e.finest().constraints.front();
        EXPECT_EQ(result.satisfied, result.reached <= bound);
        EXPECT_LE(result.reached, tried) << bound;
        EXPECT_LE(result.reached, std::max(bound, 1.2 * before)) << bound;
        EXPECT_EQ(count_manifold(e.mesh()).topology, e.report.reference);
        EXPECT_EQ(e.finest().self_intersections, 0U);
        before = result.reached;
        const bool is_tried = bound == 0.5 || bound == 0.4 || bound == 0.32 || bound == 0.256;
        if (is_tried) tried = std::min(tried, std::max(bound, result.reached));
      }
    }
  }
}

// The progress is that of the whole run, whatever is tried in between.
TEST(Progress, NeverFalls) {
  std::vector<double> reported;
  RunControl control;
  control.progress = [&](std::string_view, double fraction) { reported.push_back(fraction); };
  const Volume volume = to_volume(random_samples(Family::gyroid_cut, {16, 15, 14}, 3));
  extract(volume, options_with({{{Quantity::max_distance, 1}}, {{Quantity::max_distance, 0.3}}}),
          control);
  ASSERT_GT(reported.size(), 20U);
  EXPECT_TRUE(std::ranges::is_sorted(reported));
  EXPECT_EQ(reported.front(), 0);
  EXPECT_GT(reported.back(), 0.8);
  EXPECT_LE(reported.back(), 1);
}

// A level that cannot be improved repeats the previous one, and the next level continues from it.
TEST(Bounds, LevelsAfterOneThatCannotBeSatisfied) {
  const Volume volume = to_volume(random_samples(Family::white_noise, {9, 10, 8}, 4));
  const Extraction e = extract(volume, options_with({{{Quantity::max_distance, 0.4}},
                                                     {{Quantity::max_distance, 0.001}},
                                                     {{Quantity::normal_angle, 20}}}));
  double before = 1;
  for (std::size_t l = 1; l < 3; ++l) {
    const double reached = e.report.levels[l].constraints.front().reached;
    EXPECT_LE(reached, before);
    before = reached;
  }
  for (std::size_t l = 1; l < 4; ++l) {
    const Hierarchy::Level &coarse = e.hierarchy.levels[l - 1], &fine = e.hierarchy.levels[l];
    EXPECT_LE(coarse.vertex_count, fine.vertex_count);
    EXPECT_EQ(count_manifold(e.hierarchy.mesh(l)).topology, e.report.reference);
    EXPECT_EQ(e.report.levels[l].self_intersections, 0U);
  }
}

// The measurement finds distances between the points that the metric tests, and refinement follows
// it where bounds are not proved, as with tricubic interpolation.
TEST(Bounds, HoldAtTheSamplesOfAMeasurement) {
  std::size_t more = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    const Volume volume = to_volume(random_samples(Family::gyroid_cut, {16, 15, 17}, seed));
    ExtractOptions options = options_with({{{Quantity::max_distance, 1.5}}});
    options.surface.interpolation = Interpolation::tricubic;
    const Extraction plain = extract(volume, options);
    options.measure_samples = 50000;
    const Extraction measured = extract(volume, options);
    const LevelReport& level = measured.finest();
    EXPECT_LE(level.measured->maximum(), level.constraints.front().reached);
    EXPECT_EQ(count_manifold(measured.mesh()).topology, measured.report.reference);
    EXPECT_EQ(level.self_intersections, 0U);
    EXPECT_TRUE(level.certificate.passed);
    more += level.vertices > plain.finest().vertices;
    MeasureOptions anew;
    anew.samples = 50000;
    anew.space = Space::lps;
    anew.surface.interpolation = options.surface.interpolation;
    EXPECT_EQ(measure(measured.mesh(), volume, anew).maximum(), level.measured->maximum())
        << "of the mesh that is returned";
  }
  EXPECT_GT(more, 0U) << "else this shows nothing";
}

TEST(Bounds, ScaleWithTheVolume) {
  const Extraction one =
      extract(ball(), options_with({{{Quantity::max_distance, 0.3}, {Quantity::max_edge, 6}}}));
  for (const double scale : {0.25, 1024.0}) {  // powers of two, so that nothing is rounded
    Volume volume = ball();
    volume.view.grid.spacing = {scale, scale, scale};
    const Extraction e = extract(
        volume,
        options_with({{{Quantity::max_distance, 0.3 * scale}, {Quantity::max_edge, 6 * scale}}}));
    EXPECT_EQ(e.mesh().triangles, one.mesh().triangles);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(e.finest().constraints[i].reached, scale * one.finest().constraints[i].reached);
      EXPECT_EQ(e.finest().constraints[i].satisfied, one.finest().constraints[i].satisfied);
    }
    EXPECT_EQ((*e.finest().metrics)[0].mean, scale * (*one.finest().metrics)[0].mean);
    EXPECT_EQ((*e.finest().metrics)[4].mean, (*one.finest().metrics)[4].mean) << "ratios do not";
  }
}

// -------------------------------------------------------------------------------------------------
// priorities

TEST(Priorities, TheEarlierConstraintHasPriority) {
  const Volume volume = ball();
  const Constraint few{Quantity::max_vertices, 80}, near{Quantity::max_distance, 0.1};
  const Extraction count_first = extract(volume, options_with({{few, near}})),
                   distance_first = extract(volume, options_with({{near, few}}));
  EXPECT_TRUE(result_of(count_first.finest(), Quantity::max_vertices).satisfied);
  EXPECT_GT(count_first.finest().vertices, 40u) << "the room is used";
  EXPECT_FALSE(result_of(count_first.finest(), Quantity::max_distance).satisfied);
  EXPECT_NE(result_of(count_first.finest(), Quantity::max_distance)
                .reason.find("max-vertices comes first"),
            std::string::npos);
  EXPECT_TRUE(result_of(distance_first.finest(), Quantity::max_distance).satisfied);
  EXPECT_FALSE(result_of(distance_first.finest(), Quantity::max_vertices).satisfied);
  EXPECT_NE(result_of(distance_first.finest(), Quantity::max_vertices)
                .reason.find("max-distance comes first"),
            std::string::npos);
}

// Every reverted step must lead to a smaller one.
TEST(Priorities, ALimitOnVerticesEndsRefinementInNoise) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const Volume volume = to_volume(random_samples(Family::gyroid_cut, {12, 12, 12}, seed));
    const Extraction coarse = extract(volume, options_with({}));
    const double room = static_cast<double>(coarse.finest().vertices) + 30;
    const Extraction e = extract(
        volume, options_with({{{Quantity::max_vertices, room}, {Quantity::max_distance, 0.01}}}));
    expect_sound(e, "gyroid with noise");
    EXPECT_LE(static_cast<double>(e.finest().vertices), room);
  }
}

// Where resolving intersections took more vertices than were left, the level is refined less, but
// still refined.
TEST(Priorities, ALimitOnVerticesIsNearlyUsedUp) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const Volume volume = to_volume(random_samples(Family::white_noise, {9, 9, 9}, seed));
    const double coarse = static_cast<double>(extract(volume, options_with({})).finest().vertices);
    std::vector<LevelGoal> levels;
    for (const double share : {1.05, 1.1, 1.2})
      levels.push_back(
          {{Quantity::max_vertices, std::floor(share * coarse)}, {Quantity::max_distance, 0.01}});
    const Extraction e = extract(volume, options_with(levels));
    expect_sound(e, "white noise");
    for (std::size_t l = 0; l < levels.size(); ++l) {
      const double vertices = static_cast<double>(e.report.levels[l + 1].vertices),
                   limit = levels[l].front().bound;
      EXPECT_LE(vertices, limit);
      EXPECT_GE(vertices, 0.9 * limit) << "seed " << seed << ", level " << l + 1;
    }
  }
}

// -------------------------------------------------------------------------------------------------
// edges

TEST(Edges, FourVerticesAreEnoughForASphere) {
  const Extraction e = extract(ball(), options_with({{{Quantity::max_vertices, 4}}}));
  expect_sound(e, "ball");
  const ConstraintResult& r = result_of(e.finest(), Quantity::max_vertices);
  EXPECT_EQ(r.reached, static_cast<double>(e.finest().vertices));
  EXPECT_EQ(r.satisfied, e.finest().vertices <= 4);
}

TEST(Edges, OneVertexIsTooFewAndTheReasonHasTheNumberNeeded) {
  const Extraction e = extract(ball(), options_with({{{Quantity::max_vertices, 1}},
                                                     {{Quantity::max_distance, 0.5}},
                                                     {{Quantity::max_vertices, 1}}}));
  expect_sound(e, "ball");
  const ConstraintResult& first = e.report.levels[1].constraints[0];
  EXPECT_FALSE(first.satisfied);
  EXPECT_EQ(first.reason, "topology alone needs " + std::to_string(e.report.levels[0].vertices));
  EXPECT_EQ(e.hierarchy.levels[1].triangles, e.hierarchy.levels[0].triangles) << "and not one more";
  EXPECT_EQ(e.report.levels[3].constraints[0].reason,
            "the previous level has " + std::to_string(e.report.levels[2].vertices))
      << "topology would do with less";
}

TEST(Edges, ABalancedLevelThatRepeatsTheCoarseOneHasItsPositions) {
  ExtractOptions options = options_with({{{Quantity::max_vertices, 1}}});
  options.placement = Placement::balanced;
  const Extraction e = extract(ball(), options);
  expect_sound(e, "ball");
  EXPECT_TRUE(e.hierarchy.levels[1].own_positions == e.hierarchy.positions);
}

TEST(Edges, MoreVerticesThanCVertices) {
  const Volume volume = to_volume(sampled({9, 9, 9}, sphere({4.4, 4.6, 4.55}, 3)));
  const Extraction e = extract(volume, options_with({{{Quantity::min_vertices, 1e9}}}));
  expect_sound(e, "ball");
  const ConstraintResult& r = e.finest().constraints[0];
  EXPECT_FALSE(r.satisfied);
  EXPECT_NE(r.reason.find(std::to_string(e.report.c_vertices) + " c-vertices"), std::string::npos)
      << r.reason;
  EXPECT_GT(e.finest().vertices, e.report.c_vertices / 2);
}

TEST(Edges, MinimumBeforeALimitIsFilledEvenly) {
  const Extraction e = extract(
      ball(14), options_with({{{Quantity::min_vertices, 300}, {Quantity::max_vertices, 400}}}));
  EXPECT_TRUE(e.finest().all_satisfied());
  EXPECT_LT(e.finest().quality.edge_max, 5 * e.finest().quality.edge_min) << "not all in one place";
}

TEST(Edges, LongestShortEdgeIsLongerThanTheObject) {
  const Extraction e =
      extract(ball(), options_with({{{Quantity::min_edge, 1000}, {Quantity::max_distance, 0.1}}}));
  expect_sound(e, "ball");
  EXPECT_EQ(e.finest().vertices, e.report.levels[0].vertices) << "nothing may be added";
  EXPECT_FALSE(e.finest().constraints[0].satisfied);
  EXPECT_NE(e.finest().constraints[0].reason.find("topology alone needs shorter edges"),
            std::string::npos);
  EXPECT_NE(e.finest().constraints[1].reason.find("min-edge comes first"), std::string::npos);
}

TEST(Edges, ExtremeBoundsOfEveryQuantity) {
  const Volume volume = to_volume(sampled({8, 8, 8}, sphere({3.4, 3.6, 3.55}, 2.6)));
  for (std::size_t q = 0; q < kQuantityCount; ++q) {
    const auto quantity = static_cast<Quantity>(q);
    for (const double bound : {1e-300, 1e-30, 1e30, 1e300}) {
      const bool ratio = unit(quantity) == Unit::ratio;
      if (quantity == Quantity::min_aspect && bound > 1) continue;
      const double wanted =
          ratio && is_metric(quantity) ? (bound < 1 ? std::nextafter(1.0, 2.0) : bound) : bound;
      for (const Placement placement : {Placement::surface, Placement::balanced}) {
        const Extraction e = extract(volume, options_with({{{quantity, wanted}},
                                                           {{Quantity::normal_angle, 40}},
                                                           {{quantity, wanted}}},
                                                          placement));
        expect_sound(e, std::string(name(quantity)) + " " + std::to_string(wanted));
        if (HasFatalFailure()) return;
        const ConstraintResult& result = e.report.levels[1].constraints[0];
        // If all c-vertices are vertices, none of them is off the mesh.
        const bool perfect = is_metric(quantity) && result.reached == (ratio ? 1 : 0);
        const bool generous = perfect || (is_lower_bound(quantity) ? bound < 1 : bound > 1);
        EXPECT_EQ(result.satisfied, generous) << name(quantity) << " " << wanted;
      }
    }
  }
}

TEST(Edges, TheSmallestVolumes) {
  if (!is_thorough()) GTEST_SKIP() << kThoroughOnly;
  for (int signs = 1; signs < 255; ++signs) {
    Samples s = constant({2, 2, 2}, -3);
    for (std::size_t i = 0; i < 8; ++i) {
      if (signs >> i & 1) s.values[i] = 2;
    }
    const Placement placement = signs % 2 ? Placement::surface : Placement::balanced;
    const Extraction e = extract(
        to_volume(s), options_with({{{Quantity::max_distance, 0.25}},
                                    {{Quantity::max_distance, 0.02}, {Quantity::min_aspect, 0.5}}},
                                   placement));
    expect_sound(e, "signs " + std::to_string(signs));
    if (HasFatalFailure()) return;
  }
}

TEST(Edges, SurfacesThatAreAllBoundary) {
  Samples strip = constant({2, 2, 9}, -3);
  for (std::size_t z = 0; z < 9; ++z) strip.at(0, 0, z) = 4;
  Samples wall = constant({2, 9, 9}, -3);
  for (std::size_t z = 0; z < 9; ++z) wall.at(0, 4, z) = wall.at(1, 4, z) = 4;
  for (const Samples& s : {strip, wall}) {
    for (const Placement placement : {Placement::surface, Placement::balanced}) {
      const Extraction e = extract(
          to_volume(s),
          options_with({{{Quantity::max_distance, 0.05}}, {{Quantity::max_edge, 1}}}, placement));
      expect_sound(e, "strip");
      if (placement == Placement::surface) continue;
      for (std::size_t v = 0; v < e.hierarchy.levels[1].own_positions.size(); ++v) {
        EXPECT_EQ(e.hierarchy.levels[1].own_positions[v], e.hierarchy.positions[v])
            << "boundary vertices stay";
      }
    }
  }
}

TEST(Edges, WhiteNoise) {
  if (!is_thorough()) GTEST_SKIP() << kThoroughOnly;
  const Volume volume = to_volume(random_samples(Family::white_noise, {12, 12, 12}, 4));
  const Extraction e = extract(volume, options_with({{{Quantity::max_distance, 0.25}}}));
  expect_sound(e, "white noise");
  EXPECT_GT(e.finest().vertices, e.report.levels[0].vertices);
}

TEST(Edges, TheSameGoalTwiceAddsNothingTheSecondTime) {
  const LevelGoal goal{{Quantity::max_distance, 0.2}};
  const Extraction e = extract(ball(), options_with({goal, goal}));
  EXPECT_EQ(e.report.levels[2].vertices, e.report.levels[1].vertices);
  EXPECT_TRUE(e.finest().all_satisfied());
}

TEST(Edges, OnlyShape) {
  const Extraction e = extract(ball(), options_with({{{Quantity::min_aspect, 0.4}}}));
  expect_sound(e, "ball");
  EXPECT_TRUE(e.finest().all_satisfied()) << e.finest().constraints[0].reason;
  EXPECT_GE(e.finest().quality.aspect_min, 0.4);
}

TEST(Edges, NoConstraintsForALevelKeepThePreviousLevel) {
  const Extraction e = extract(ball(), options_with({{{Quantity::max_distance, 0.2}}, {}}));
  expect_sound(e, "ball");
  EXPECT_EQ(e.report.levels[2].vertices, e.report.levels[1].vertices);
}

TEST(Edges, TheCoarseLevelIsOnlyMeasured) {
  ExtractOptions options = options_with({});
  const Extraction plain = extract(ball(), options);
  EXPECT_FALSE(plain.finest().metrics.has_value());
  options.coarse = {
      {Quantity::max_distance, 1e-3}, {Quantity::min_vertices, 1}, {Quantity::max_vertices, 1}};
  const Extraction e = extract(ball(), options);
  EXPECT_EQ(e.mesh().triangles, plain.mesh().triangles);
  EXPECT_EQ(e.finest().constraints[0].reason, "the coarse mesh is not refined");
  EXPECT_TRUE(e.finest().constraints[1].satisfied);
  EXPECT_EQ(e.finest().constraints[2].reason,
            "topology alone needs " + std::to_string(e.finest().vertices));
}

// ----------------------------------------------------------------------------------------------
// refusals and cancelling

TEST(Refuses, BoundsThatAQuantityCannotHave) {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  const auto refused = [](const LevelGoal& goal, const std::string& word) {
    for (const bool coarse : {false, true}) {
      ExtractOptions options = coarse_options();
      (coarse ? options.coarse : options.refine.emplace_back()) = goal;
      try {
        extract(ball(), options);
        ADD_FAILURE() << "no error about " << word;
      } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::bad_argument);
        EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
      }
    }
  };
  for (std::size_t q = 0; q < kQuantityCount; ++q) {
    const auto quantity = static_cast<Quantity>(q);
    const std::string what(name(quantity));
    for (const double bad : {0.0, -0.0, -1.0, nan, infinity, -infinity})
      refused({{quantity, bad}}, what);
    if (is_metric(quantity) && unit(quantity) == Unit::ratio) refused({{quantity, 1}}, what);
    refused({{quantity, quantity == Quantity::min_aspect ? 0.5 : 2},
             {quantity, quantity == Quantity::min_aspect ? 0.4 : 3}},
            "twice");
  }
  refused({{Quantity::min_aspect, 1}}, "min-aspect");
}

TEST(Cancelling, StopsRefinement) {
  const Volume volume = ball(14);
  for (const int after : {0, 1, 4}) {
    std::atomic<bool> cancel{false};
    int seen = 0;
    RunControl control;
    control.cancel = &cancel;
    control.progress = [&](std::string_view stage, double fraction) {
      EXPECT_GE(fraction, 0);
      EXPECT_LE(fraction, 1);
      if (cancel) ADD_FAILURE() << "progress of " << stage << " was reported after cancellation";
      if (stage == "refine" && seen++ == after) cancel = true;
    };
    try {
      extract(volume, options_with({{{Quantity::max_distance, 0.02}}}), control);
      ADD_FAILURE() << "not cancelled";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled);
    }
  }
}

}  // namespace
}  // namespace isoatlas::detail
