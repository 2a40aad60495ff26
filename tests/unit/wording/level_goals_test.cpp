// SPDX-License-Identifier: Apache-2.0
#include "wording/level_goals.h"

#include <gtest/gtest.h>

#include <string>

#include "isoatlas/error.h"

namespace isoatlas::detail {
namespace {

using enum Quantity;

template <class Run>
std::string message_of(Run run) {
  try {
    run();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_argument);
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

std::string refusal(const std::string& spec) {
  return message_of([&] { parse_level(spec); });
}

TEST(ParseLevel, EveryUnit) {
  const std::vector<TypedConstraint> expected{
      {max_distance, 0.5, true},
      {mean_distance, 2, false, false, LengthUnit::millimetre},
      {min_edge, 2},
      {area_curvature, 1.1},
      {normal_angle, 15},
      {max_vertices, 2000},
      {min_aspect, 0.25},
      {max_edge, 1e3, true},
      {geodesic_ratio, 1.5},
      {min_vertices, 4},
      {area_curvature_smooth, 3}};
  EXPECT_EQ(parse_level("max-distance:0.5vx,mean-distance:2mm,min-edge:2,area-curvature:1.1,normal-"
                        "angle:15deg,max-vertices:2000,"
                        "min-aspect:0.25,max-edge:1e3vx,geodesic-ratio:+1.5,min-vertices:4,area-"
                        "curvature-smooth:3"),
            expected);
  EXPECT_EQ(parse_bound(normal_angle, "15"), parse_bound(normal_angle, "15deg"));
}

TEST(ParseLevel, IgnoresCaseBlanksAndUnderscores) {
  EXPECT_EQ(parse_level("max-distance: 0.5vx"), parse_level("max-distance:0.5vx"));
  EXPECT_EQ(parse_level(" Max_Distance : 0.5 VX , max-vertices: 20 "),
            parse_level("max-distance:0.5vx,max-vertices:20"));
  EXPECT_EQ(parse_bound(normal_angle, " 15 deg "), parse_bound(normal_angle, "15deg"));
  EXPECT_EQ(parse_bound(max_distance, "0.5 mm"), parse_bound(max_distance, "0.5mm"));
}

TEST(ParseLevel, RefusesADecimalComma) {
  EXPECT_EQ(refusal("max-distance:0,5vx"),
            "expected a decimal point before '5vx', not a comma, in 'max-distance:0,5vx'");
}

TEST(ParseBound, RefusesADecimalComma) {
  const auto refused = [](Quantity quantity, const char* text) -> std::string {
    try {
      parse_bound(quantity, text);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refused(max_distance, "0,5vx"),
            "max-distance: expected a length above 0 like 0.5vx, 2mm or 2, with a decimal point "
            "(0.5vx), got '0,5vx'");
  EXPECT_EQ(refused(max_vertices, "5,5").find("decimal"), std::string::npos);
}

TEST(ParseLevel, MessagesStateTheFaultAndTheExpectedText) {
  EXPECT_EQ(refusal("max-distance"),
            "expected METRIC:BOUND[,METRIC:BOUND...] like max-distance:0.5vx, got 'max-distance'");
  EXPECT_NE(refusal("max-distance:1,oops").find("got 'oops' in 'max-distance:1,oops'"),
            std::string::npos);
  const std::string unknown = refusal("max-dist:1");
  for (std::size_t i = 0; i < kQuantityCount; ++i)
    EXPECT_NE(unknown.find(name(static_cast<Quantity>(i))), std::string::npos);
  EXPECT_EQ(refusal("normal-angle:1vx"),
            "normal-angle: expected an angle above 0 like 15deg or 15, got '1vx'");
  for (const char* bad : {"",
                          ":",
                          ",",
                          "max-distance:1,",
                          ",max-distance:1",
                          "max-distance:",
                          "max-distance:0",
                          "max-distance:-1",
                          "max-distance:inf",
                          "max-distance:1 px",
                          "area-curvature:1",
                          "area-curvature:inf",
                          "geodesic-ratio:1vx",
                          "normal-angle:0",
                          "normal-angle:nan",
                          "max-vertices:3",
                          "max-vertices:4.5",
                          "max-vertices:-9",
                          "max-vertices:4294967296",
                          "min-aspect:0",
                          "min-aspect:1",
                          "min-aspect:nan",
                          "max distance:1"})
    EXPECT_FALSE(refusal(bad).empty()) << bad;
}

GoalArgument level(const char* spec) { return {true, parse_level(spec)}; }
GoalArgument option(Quantity quantity, const char* bound) {
  return {false, {parse_bound(quantity, bound)}};
}

TEST(PlanLevels, OrderIsPriority) {
  const auto before =
      plan_levels({option(max_vertices, "500"), level("max-distance:0.5vx")}, false);
  EXPECT_EQ(before.refine, (std::vector<std::vector<TypedConstraint>>{
                               {{max_vertices, 500}, {max_distance, 0.5, true}}}));
  const auto after = plan_levels({level("max-distance:0.5vx"), option(max_vertices, "500")}, false);
  EXPECT_EQ(after.refine, (std::vector<std::vector<TypedConstraint>>{
                              {{max_distance, 0.5, true}, {max_vertices, 500}}}));
  EXPECT_TRUE(after.coarse.empty());
}

TEST(PlanLevels, OptionsApplyToEveryLevelInTheirOrder) {
  const auto goals =
      plan_levels({option(min_edge, "1"), level("max-distance:2,max-vertices:90"),
                   option(min_aspect, "0.1"), level("max-distance:1"), option(max_edge, "9")},
                  false);
  ASSERT_EQ(goals.refine.size(), 2U);
  EXPECT_EQ(
      goals.refine[0],
      (std::vector<TypedConstraint>{
          {min_edge, 1}, {max_distance, 2}, {max_vertices, 90}, {min_aspect, 0.1}, {max_edge, 9}}));
  EXPECT_EQ(goals.refine[1],
            (std::vector<TypedConstraint>{
                {min_edge, 1}, {min_aspect, 0.1}, {max_distance, 1}, {max_edge, 9}}));
}

TEST(PlanLevels, Defaults) {
  EXPECT_EQ(plan_levels({}, false).refine,
            (std::vector<std::vector<TypedConstraint>>{{{max_distance, 0.5, true, true}}}));
  EXPECT_EQ(plan_levels({option(max_vertices, "50")}, false).refine[0],
            (std::vector<TypedConstraint>{{max_vertices, 50}, {max_distance, 0.5, true, true}}));
  EXPECT_EQ(plan_levels({option(normal_angle, "10")}, false).refine[0],
            (std::vector<TypedConstraint>{{normal_angle, 10}}));
  EXPECT_EQ(plan_levels({level("max-vertices:50")}, false).refine[0],
            (std::vector<TypedConstraint>{{max_vertices, 50}}));
}

// The default bound is half of the smallest spacing, or an eighth of the largest if that is more
// than four times the smallest. A typed bound does not depend on the largest spacing.
TEST(DefaultBound, GrowsWithThickLayers) {
  const TypedConstraint default_bound = plan_levels({}, false).refine[0][0],
                        typed{max_distance, 0.5, true};
  const auto bounds = [&](double x, double y, double z) {
    Grid grid;
    grid.spacing = {x, y, z};
    EXPECT_TRUE(default_bound.in_world(grid).is_default);
    return std::pair(default_bound.in_world(grid).bound, typed.in_world(grid).bound);
  };
  EXPECT_EQ(bounds(0.7, 0.7, 0.7), std::pair(0.5 * 0.7, 0.5 * 0.7));
  EXPECT_EQ(bounds(3, 1, 1), std::pair(0.5, 0.5));
  EXPECT_EQ(bounds(1, 4, 1), std::pair(0.5, 0.5));
  EXPECT_EQ(bounds(0.5, 0.5, 3), std::pair(0.375, 0.25));
  EXPECT_EQ(bounds(8, 0.5, 0.5), std::pair(1.0, 0.25));
}

TEST(PlanLevels, OnlyCoarse) {
  const auto goals = plan_levels({option(max_vertices, "50"), option(max_distance, "1")}, true);
  EXPECT_EQ(goals.coarse, (std::vector<TypedConstraint>{{max_vertices, 50}, {max_distance, 1}}));
  EXPECT_TRUE(goals.refine.empty());
  EXPECT_TRUE(plan_levels({}, true).coarse.empty());
  EXPECT_NE(message_of([] { plan_levels({level("max-distance:1")}, true); }).find("--coarse"),
            std::string::npos);
}

TEST(PlanLevels, AQuantityTwiceIsAnError) {
  EXPECT_EQ(message_of([] {
              plan_levels({level("max-distance:1"), level("max-edge:1,max-edge:2")}, false);
            }),
            "max-edge is given twice for level 2, expected once");
  EXPECT_EQ(message_of([] {
              plan_levels({level("max-edge:1"), option(max_edge, "1")}, false);
            }),
            "max-edge is given twice for level 1, expected once");
  EXPECT_EQ(message_of([] {
              plan_levels({option(max_edge, "1"), option(max_edge, "1")}, true);
            }),
            "max-edge is given twice for level 0, expected once");
}

TEST(PlanLevels, LengthsInWorldUnits) {
  Grid grid;
  grid.spacing = {3, 2, 4};
  EXPECT_EQ(in_world({{max_distance, 0.5, true, true}, {max_edge, 7}, {max_vertices, 9}}, grid),
            (LevelGoal{{max_distance, 1, true}, {max_edge, 7}, {max_vertices, 9}}));
}

}  // namespace
}  // namespace isoatlas::detail
