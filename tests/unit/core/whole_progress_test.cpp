// SPDX-License-Identifier: Apache-2.0
#include "core/whole_progress.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace isoatlas {
namespace {

TEST(WholeProgress, NeverFallsAndEndsAtOne) {
  std::vector<std::pair<std::string, double>> told;
  RunControl control;
  control.progress = [&](std::string_view stage, double fraction) { told.emplace_back(stage, fraction); };
  constexpr std::array<StageShare, 3> kStages{{{"one", 1}, {"two", 2}, {"three", 1}}};
  const RunControl whole = with_whole_progress(control, kStages);
  whole.report("one", 0);
  whole.report("one", 0.5);
  whole.report("two", 0.25);
  whole.report("two", 0.1);   // less than before
  whole.report("else", 0.9);  // part of the stage before it
  whole.report("two", 7);
  whole.report("three", 1);
  const std::vector<std::pair<std::string, double>> want{{"one", 0}, {"one", 0.125}, {"two", 0.375}, {"two", 0.375}, {"else", 0.375}, {"two", 0.75}, {"three", 1}};
  EXPECT_EQ(told, want);
}

TEST(WholeProgress, WithoutAListenerThereIsNone) {
  constexpr std::array<StageShare, 1> kStages{{{"one", 1}}};
  EXPECT_FALSE(with_whole_progress({}, kStages).progress);
}

}  // namespace
}  // namespace isoatlas
