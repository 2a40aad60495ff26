// SPDX-License-Identifier: Apache-2.0
#include "outputs/stated_rounding.h"

#include <gtest/gtest.h>

#include <limits>

namespace isoatlas::detail {
namespace {

ConstraintResult result(Quantity quantity, double bound, double reached, bool is_default = false) {
  ConstraintResult out;
  out.constraint = {.quantity = quantity, .bound = bound};
  out.constraint.is_default = is_default;
  out.reached = reached;
  out.satisfied = quantity == Quantity::min_edge || quantity == Quantity::min_aspect
                      ? reached >= bound
                      : reached <= bound;
  return out;
}

// A report with two levels that have the same metrics and constraints.
ExtractReport report_with(std::vector<ConstraintResult> constraints) {
  ExtractReport report;
  for (int k = 0; k < 2; ++k) {
    LevelReport level;
    level.metrics.emplace();
    for (MetricSummary& metric : *level.metrics) metric = {.maximum = 2, .mean = 1};
    level.constraints = constraints;
    report.levels.push_back(level);
  }
  return report;
}

FileRounding file(const std::string& path, std::vector<std::size_t> levels, double rounding) {
  return {.path = path, .levels = std::move(levels), .largest = rounding};
}

TEST(StatedRounding, IsAddedToLengthsOnly) {
  ExtractReport report = report_with(
      {result(Quantity::max_distance, 0.5, 0.4), result(Quantity::mean_distance, 0.5, 0.4),
       result(Quantity::max_edge, 5, 4), result(Quantity::min_edge, 1, 3),
       result(Quantity::normal_angle, 30, 20), result(Quantity::max_vertices, 100, 90)});
  state_rounding(report, {file("a.stl", {1}, 0.0625)}, {}, Space::lps);
  const LevelReport& level = report.levels[1];
  EXPECT_EQ(level.rounding, 0.0625);
  const std::vector<double> reached{0.4625, 0.4625, 4.125, 2.875, 20, 90};
  for (std::size_t i = 0; i < reached.size(); ++i) {
    EXPECT_DOUBLE_EQ(level.constraints[i].reached, reached[i]) << i;
    EXPECT_TRUE(level.constraints[i].satisfied) << i;
    EXPECT_EQ(level.constraints[i].reason, "");
  }
  for (std::size_t i = 0; i < kMetricCount; ++i) {
    const bool is_distance = i < 2;
    EXPECT_EQ((*level.metrics)[i].maximum, is_distance ? 2.0625 : 2);
    EXPECT_EQ((*level.metrics)[i].mean, is_distance ? 1.0625 : 1);
  }
  EXPECT_EQ(report.levels[0].rounding, 0);  // in no file
  EXPECT_EQ(report.levels[0].constraints[0].reached, 0.4);
}

TEST(StatedRounding, ABoundCanBeViolatedByRoundingAlone) {
  ExtractReport report = report_with(
      {result(Quantity::max_distance, 0.5, 0.45), result(Quantity::max_distance, 0.5, 0.45, true),
       result(Quantity::min_edge, 1, 1.1), result(Quantity::max_edge, 5, 4.9),
       result(Quantity::max_distance, 0.4, 0.45)});
  report.levels[1].constraints[4].reason = "too coarse";
  state_rounding(report, {file("a.stl", {1}, 0.1)}, {}, Space::lps);
  const std::vector<ConstraintResult>& results = report.levels[1].constraints;
  for (const ConstraintResult& r : results) EXPECT_FALSE(r.satisfied);
  EXPECT_EQ(results[0].reason, "positions are rounded to float32 in a.stl, by up to 0.1");
  EXPECT_EQ(results[4].reason, "too coarse");  // violated before rounding
  EXPECT_FALSE(report.levels[1].all_satisfied());
  report.levels[1].constraints = {results[1]};
  EXPECT_TRUE(report.levels[1].all_satisfied());  // a default bound does not count
}

TEST(StatedRounding, IsThatOfTheWorstFileOfALevel) {
  ExtractReport report = report_with({result(Quantity::max_distance, 0.5, 0.45)});
  state_rounding(report,
                 {file("a.glb", {0, 1}, 0.01), file("a-0.glb", {0}, 0.02),
                  file("a-1.glb", {1}, 0.1), file("b.ply", {1}, 0)},
                 {}, Space::lps);
  EXPECT_EQ(report.levels[0].rounding, 0.02);
  EXPECT_TRUE(report.levels[0].constraints[0].satisfied);
  EXPECT_EQ(report.levels[1].rounding, 0.1);
  EXPECT_FALSE(report.levels[1].constraints[0].satisfied);
}

TEST(StatedRounding, OfSampleIndicesIsConvertedToWorldUnits) {
  Grid grid;
  grid.spacing = {0.5, 0.25, 3};
  EXPECT_EQ(rounding_in_world(0.125, grid, Space::voxel), 0.375);
  EXPECT_EQ(rounding_in_world(0.125, grid, Space::ras), 0.125);
}

TEST(StatedRounding, AnInfiniteMetricStaysInfinite) {
  ExtractReport report =
      report_with({result(Quantity::max_distance, 0.5, std::numeric_limits<double>::infinity())});
  state_rounding(report, {file("a.stl", {0, 1}, 0.1)}, {}, Space::lps);
  EXPECT_EQ(report.levels[1].constraints[0].reached, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace isoatlas::detail
