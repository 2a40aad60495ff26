// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>

#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// A stage of a computation, and how long it takes beside the others.
struct StageShare {
  std::string_view stage;
  double share;
};

/// The same control, but it reports the fraction of the whole computation instead of that of a stage. The fraction never falls, even if a
/// stage reports less than before. A stage that is not in `stages`, or is over, counts as part of the stage before it.
RunControl with_whole_progress(const RunControl& control, std::span<const StageShare> stages);

/// Says that the stage that was reported last goes on, for work of which nobody knows how much there is: the fraction of the whole
/// computation rises by a small share of what that stage has left.
void report_going_on(const RunControl& control);

/// for_each_piece() for loops that may take long: says from time to time that the work goes on.
/// @param control  none: nobody is told
void for_each_piece_going_on(std::size_t n, std::size_t grain, const RunControl* control,
                             const std::function<void(std::size_t, std::size_t)>& body);

/// The same control for work that is part of a stage and has reports of its own: only report_going_on() comes through.
RunControl without_stages(const RunControl& control);

}  // namespace isoatlas::detail
