// SPDX-License-Identifier: Apache-2.0
// Levels whose bounds are in equal ratios: ladder() and ExtractOptions::levels.
#include <gtest/gtest.h>

#include <cmath>

#include "isoatlas/error.h"
#include "isoatlas/extract.h"
#include "support/exact_volume.h"
#include "support/mesh_counts.h"

namespace isoatlas::detail {
namespace {

using namespace test;

std::vector<double> bounds_of(const std::vector<LevelGoal>& goals) {
  std::vector<double> bounds;
  for (const LevelGoal& goal : goals)
    for (const Constraint& c : goal)
      if (c.quantity == Quantity::max_distance) bounds.push_back(c.bound);
  return bounds;
}

std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_argument);
    return error.what();
  }
  return "no error";
}

Volume ball(double radius) {
  const double c = radius + 2.45;
  const auto n = static_cast<std::size_t>(2 * radius + 6);
  return exact_volume({n, n, n}, sphere({c, c + 0.1, c + 0.05}, radius));
}

Extraction planned(const Volume& volume, std::uint32_t levels, LevelGoal finest = default_goal(),
                   Placement placement = Placement::surface) {
  ExtractOptions options;
  options.levels = levels;
  options.refine = {std::move(finest)};
  options.placement = placement;
  return extract(volume, options);
}

std::vector<double> bounds_of(const Extraction& extraction) {
  std::vector<double> bounds;
  for (const LevelReport& level : extraction.report.levels)
    bounds.push_back(level.constraints.front().constraint.bound);
  return bounds;
}

TEST(Ladder, BoundsAreInEqualRatios) {
  EXPECT_EQ(bounds_of(ladder(4, within(0.5 * vx), 4 * vx)), (std::vector<double>{4, 2, 1, 0.5}));
  EXPECT_EQ(bounds_of(ladder(3, within(0.25), 0.25)), (std::vector<double>{0.25, 0.25, 0.25}));
  EXPECT_EQ(bounds_of(ladder(1, within(0.25), 9)), (std::vector<double>{0.25}));
  EXPECT_TRUE(ladder(2, within(0.5 * vx), 4 * vx)[0][0].in_voxels);
}

TEST(Ladder, OtherConstraintsHoldInEveryLevel) {
  const LevelGoal finest{bounded(Quantity::max_vertices, 900), within(1.0)};
  for (const LevelGoal& goal : ladder(3, finest, 4)) {
    ASSERT_EQ(goal.size(), 2u);
    EXPECT_EQ(goal[0], finest[0]);
  }
}

TEST(Ladder, RefusesWhatHasNoRange) {
  EXPECT_NE(message_of([] { ladder(0, within(1.0), 2); }).find("at least one level"),
            std::string::npos);
  EXPECT_NE(message_of([] { ladder(2, bounded(Quantity::min_aspect, 0.3), 2); }).find("max-dist"),
            std::string::npos);
  EXPECT_NE(message_of([] { ladder(2, within(1.0), 2 * vx); }).find("both be in voxels"),
            std::string::npos);
  for (const double coarsest : {0.5, 0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_NE(message_of([&] { ladder(2, within(1.0), coarsest); }).find("at least that"),
              std::string::npos)
        << coarsest;
}

TEST(Levels, HaveTheNumberAndTheBoundsThatWereRequested) {
  const Extraction found = planned(ball(40), 3, within(0.3));
  EXPECT_EQ(bounds_of(found), (std::vector<double>{1.2, 0.6, 0.3}));
  ASSERT_EQ(found.hierarchy.levels.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_TRUE(found.report.levels[k].all_satisfied()) << k;
    EXPECT_EQ(count_mesh(found.hierarchy.mesh(k)).fault, "") << k;
    EXPECT_EQ(found.report.levels[k].triangles, found.hierarchy.levels[k].triangles.size());
  }
}

// A bound of half the radius would allow a tetrahedron.
TEST(Levels, TheCoarsestOfASmallBallIsStillABall) {
  const double radius = 15;
  const Extraction found = planned(ball(radius), 6);
  const std::vector<double> bounds = bounds_of(found);
  EXPECT_LT(bounds.front(), 0.13 * radius);
  for (std::size_t k = 1; k + 1 < bounds.size(); ++k)
    EXPECT_NEAR(bounds[k - 1] / bounds[k], bounds[k] / bounds[k + 1], 1e-9) << "equal ratios";
  EXPECT_EQ(bounds.back(), 0.5);
  EXPECT_GE(found.report.levels.front().vertices, 24u);
  const double volume = 4.0 / 3 * M_PI * std::pow(radius, 3);
  EXPECT_GT(*found.report.levels.front().extent.volume, 0.8 * volume);
}

TEST(Levels, AreNestedAndNewVerticesHaveParentsInThePreviousLevel) {
  const Hierarchy levels = planned(ball(20), 3).hierarchy;
  ASSERT_EQ(levels.parent.size(), levels.positions.size());
  const std::uint32_t coarsest = levels.levels.front().vertex_count;
  EXPECT_GT(coarsest, 4u);
  for (std::uint32_t v = 0; v < levels.positions.size(); ++v) {
    const std::uint32_t level = levels.level_of(v);
    if (level == 0)
      EXPECT_EQ(levels.parent[v], v);
    else
      EXPECT_LT(levels.parent[v], levels.levels[level - 1].vertex_count);
  }
}

TEST(Levels, OneLevelIsTheFinest) {
  const Volume volume = ball(9);
  const Extraction one = planned(volume, 1), refined = extract(volume, 0);
  EXPECT_EQ(one.hierarchy.levels.size(), 1u);
  EXPECT_EQ(one.mesh().triangles, refined.mesh().triangles);
}

TEST(Levels, BalancedPlacementGivesEachLevelItsPositions) {
  const Extraction found = planned(ball(20), 3, within(0.4), Placement::balanced);
  for (const Hierarchy::Level& level : found.hierarchy.levels)
    EXPECT_EQ(level.own_positions.size(), level.vertex_count);
}

TEST(Levels, ABoundThatTheCoarsestCannotExceedIsKept) {
  const Extraction found = planned(ball(3), 4, within(1.0));
  EXPECT_EQ(bounds_of(found), (std::vector<double>{1, 1, 1, 1}));
}

TEST(Levels, RefuseWhatContradictsThem) {
  const Volume volume = ball(4);
  const auto message_with = [&](const std::function<void(ExtractOptions&)>& change) {
    ExtractOptions options;
    options.levels = 2;
    change(options);
    return message_of([&] { extract(volume, options); });
  };
  EXPECT_NE(message_with([](auto& o) { o.levels = 17; }).find("at most 16"), std::string::npos);
  EXPECT_NE(message_with([](auto& o) { o.refine.clear(); }).find("one goal"), std::string::npos);
  EXPECT_NE(message_with([](auto& o) { o.refine.push_back(within(1)); }).find("one goal"),
            std::string::npos);
  EXPECT_NE(message_with([](auto& o) { o.coarse = within(1); }).find("coarse"), std::string::npos);
  EXPECT_NE(message_with([](auto& o) {
              o.refine = {bounded(Quantity::normal_angle, 20)};
            }).find("max-distance"),
            std::string::npos);
}

}  // namespace
}  // namespace isoatlas::detail
