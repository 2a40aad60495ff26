// SPDX-License-Identifier: Apache-2.0
#include "core/whole_progress.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "core/ranges.h"

namespace isoatlas::detail {
namespace {

struct Interval {
  std::string stage;
  double from, to;
};

struct LastReport {
  std::string stage;  // the last stage reported
  double fraction = 0, end = 0;
};

constexpr std::size_t kChunksPerReport = 1024;
constexpr std::string_view kContinues = "";  // stands for the current stage
constexpr double kStep = 1.0 / 256;          // share of what the stage has left

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
  const auto last_report = std::make_shared<LastReport>();
  out.progress = [report = control.progress, intervals, last_report](std::string_view stage,
                                                                     double fraction) {
    const auto found = ranges::find(intervals, stage, &Interval::stage);
    const bool is_over = found != intervals.end() && found->to <= last_report->fraction;
    if (stage == kContinues) {
      last_report->fraction += kStep * (last_report->end - last_report->fraction);
    } else if (!is_over) {
      last_report->stage = stage;
      if (found != intervals.end()) {
        last_report->fraction =
            std::max(last_report->fraction,
                     found->from + std::clamp(fraction, 0.0, 1.0) * (found->to - found->from));
        last_report->end = found->to;
      }
    }
    report(last_report->stage, last_report->fraction);
  };
  return out;
}

void report_continuing(const RunControl& control) { control.report(kContinues, 0); }

void for_each_chunk_reporting(std::size_t n, std::size_t grain, const RunControl* control,
                              const std::function<void(std::size_t, std::size_t)>& body) {
  const std::size_t block = kChunksPerReport * grain;
  for (std::size_t first = 0; first < n; first += block) {
    if (first > 0 && control != nullptr) report_continuing(*control);
    for_each_chunk(std::min(block, n - first), grain,
                   [&](std::size_t begin, std::size_t end) { body(first + begin, first + end); });
  }
}

RunControl without_stages(const RunControl& control) {
  RunControl out = control;
  if (!control.progress) return out;
  out.progress = [report = control.progress](std::string_view stage, double fraction) {
    if (stage == kContinues) report(stage, fraction);
  };
  return out;
}

}  // namespace isoatlas::detail
