// SPDX-License-Identifier: Apache-2.0
#include "core/whole_progress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace isoatlas::detail {
namespace {

TEST(WholeProgress, NeverFallsAndEndsAtOne) {
  std::vector<std::pair<std::string, double>> reported;
  RunControl control;
  control.progress = [&](std::string_view stage, double fraction) {
    reported.emplace_back(stage, fraction);
  };
  constexpr std::array<StageShare, 3> kStages{{{"one", 1}, {"two", 2}, {"three", 1}}};
  const RunControl whole = with_whole_progress(control, kStages);
  whole.report("one", 0);
  whole.report("one", 0.5);
  whole.report("two", 0.25);
  whole.report("two", 0.1);   // less than before
  whole.report("else", 0.9);  // counts as part of the previous stage
  whole.report("two", 7);
  whole.report("three", 1);
  const std::vector<std::pair<std::string, double>> want{
      {"one", 0},      {"one", 0.125}, {"two", 0.375}, {"two", 0.375},
      {"else", 0.375}, {"two", 0.75},  {"three", 1}};
  EXPECT_EQ(reported, want);
}

TEST(WholeProgress, AStageContinues) {
  std::string stage;
  double fraction = 0;
  RunControl control;
  control.progress = [&](std::string_view s, double f) {
    stage = s;
    fraction = f;
  };
  constexpr std::array<StageShare, 2> kStages{{{"one", 1}, {"two", 1}}};
  const RunControl whole = with_whole_progress(control, kStages), inner = without_stages(whole);
  whole.report("one", 0.2);
  inner.report("two", 0.9);
  EXPECT_EQ(std::pair(stage, fraction), std::pair(std::string("one"), 0.1))
      << "a report of work that is part of the stage";
  for (int k = 0; k < 1000; ++k) {
    const double before = fraction;
    report_continuing(inner);
    EXPECT_EQ(stage, "one");
    EXPECT_GE(fraction, before);
    EXPECT_LE(fraction, 0.5);
    if (k < 100) {
      EXPECT_GT(fraction, before + 2e-3 * (0.5 - before)) << "it stands still";
    }
  }
  whole.report("two", 0);
  EXPECT_EQ(fraction, 0.5);
  whole.report("one", 0.3);
  EXPECT_EQ(stage, "two") << "the first one is over";
  report_continuing(whole);
  EXPECT_GT(fraction, 0.5);
  EXPECT_FALSE(without_stages({}).progress);
}

TEST(WholeProgress, PiecesAreProcessedOnceAndReported) {
  constexpr std::size_t kItems = 10000, kGrain = 3;
  int reported = 0;
  RunControl control;
  control.progress = [&](std::string_view, double) { ++reported; };
  for (const RunControl* who :
       {static_cast<const RunControl*>(nullptr), static_cast<const RunControl*>(&control)}) {
    std::vector<int> times(kItems, 0);
    for_each_chunk_reporting(kItems, kGrain, who, [&](std::size_t begin, std::size_t end) {
      EXPECT_LE(end - begin, kGrain);
      for (std::size_t i = begin; i < end; ++i) ++times[i];
    });
    EXPECT_EQ(std::ranges::count(times, 1), static_cast<std::ptrdiff_t>(kItems));
  }
  EXPECT_EQ(reported, 3);
}

TEST(WholeProgress, WithoutAListenerNothingIsReported) {
  constexpr std::array<StageShare, 1> kStages{{{"one", 1}}};
  EXPECT_FALSE(with_whole_progress({}, kStages).progress);
}

}  // namespace
}  // namespace isoatlas::detail
