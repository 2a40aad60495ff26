// SPDX-License-Identifier: Apache-2.0
#include "core/whole_progress.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace isoatlas {
namespace {

struct Interval {
  std::string stage;
  double from, to;
};

}  // namespace

RunControl with_whole_progress(const RunControl& control, std::span<const StageShare> stages) {
  RunControl out = control;
  if (!control.progress) return out;
  double total = 0, before = 0;
  for (const StageShare& s : stages) total += s.share;
  std::vector<Interval> intervals;
  for (const StageShare& s : stages) {
    intervals.push_back({std::string(s.stage), before / total, (before + s.share) / total});
    before += s.share;
  }
  const auto told = std::make_shared<double>(0);
  out.progress = [tell = control.progress, intervals, told](std::string_view stage, double fraction) {
    const auto found = std::ranges::find(intervals, stage, &Interval::stage);
    if (found != intervals.end()) *told = std::max(*told, found->from + std::clamp(fraction, 0.0, 1.0) * (found->to - found->from));
    tell(stage, *told);
  };
  return out;
}

}  // namespace isoatlas
