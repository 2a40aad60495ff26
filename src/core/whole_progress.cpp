// SPDX-License-Identifier: Apache-2.0
#include "core/whole_progress.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "core/parallel.h"

namespace isoatlas::detail {
namespace {

struct Interval {
  std::string stage;
  double from, to;
};

struct Told {
  std::string stage;  // the last one
  double fraction = 0, end = 0;
};

constexpr std::size_t kPiecesToAReport = 1024;
constexpr std::string_view kGoesOn = "";  // instead of a stage
constexpr double kStep = 1.0 / 256;       // of what a stage has left

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
  const auto told = std::make_shared<Told>();
  out.progress = [tell = control.progress, intervals, told](std::string_view stage, double fraction) {
    const auto found = std::ranges::find(intervals, stage, &Interval::stage);
    const bool is_over = found != intervals.end() && found->to <= told->fraction;
    if (stage == kGoesOn) {
      told->fraction += kStep * (told->end - told->fraction);
    } else if (!is_over) {
      told->stage = stage;
      if (found != intervals.end()) {
        told->fraction = std::max(told->fraction, found->from + std::clamp(fraction, 0.0, 1.0) * (found->to - found->from));
        told->end = found->to;
      }
    }
    tell(told->stage, told->fraction);
  };
  return out;
}

void report_going_on(const RunControl& control) { control.report(kGoesOn, 0); }

void for_each_piece_going_on(std::size_t n, std::size_t grain, const RunControl* control,
                             const std::function<void(std::size_t, std::size_t)>& body) {
  const std::size_t block = kPiecesToAReport * grain;
  for (std::size_t first = 0; first < n; first += block) {
    if (first > 0 && control != nullptr) report_going_on(*control);
    for_each_piece(std::min(block, n - first), grain, [&](std::size_t begin, std::size_t end) { body(first + begin, first + end); });
  }
}

RunControl without_stages(const RunControl& control) {
  RunControl out = control;
  if (!control.progress) return out;
  out.progress = [tell = control.progress](std::string_view stage, double fraction) {
    if (stage == kGoesOn) tell(stage, fraction);
  };
  return out;
}

}  // namespace isoatlas::detail
