// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>

#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// A stage of a computation, and its duration relative to the others.
struct StageShare {
  std::string_view stage;
  double share;
};

/// Returns a control that reports the fraction of the whole computation instead of that of a stage.
/// The fraction never decreases, even if a stage reports less than before. A stage that is not in
/// `stages`, or has ended, counts as part of the previous one.
RunControl with_whole_progress(const RunControl& control, std::span<const StageShare> stages);

/// Reports that the current stage continues, for work of unknown extent: the fraction of the whole
/// computation increases by a small share of what the stage has left.
void report_continuing(const RunControl& control);

/// for_each_chunk() for long loops: regularly reports that the current stage continues.
/// @param control  none: nothing is reported
void for_each_chunk_reporting(std::size_t n, std::size_t grain, const RunControl* control,
                              const std::function<void(std::size_t, std::size_t)>& body);

/// Returns a control for work that is part of a stage and has reports of its own: only
/// report_continuing() is passed on.
RunControl without_stages(const RunControl& control);

}  // namespace isoatlas::detail
