// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

#include "isoatlas/run_control.h"

namespace isoatlas {

/// A stage of a computation, and how long it takes beside the others.
struct StageShare {
  std::string_view stage;
  double share;
};

/// The same control, which tells the fraction of the whole computation instead of that of a stage. What it tells never falls, also where a
/// stage reports less than before, or is none of `stages`: these are part of the stage that comes before.
RunControl with_whole_progress(const RunControl& control, std::span<const StageShare> stages);

}  // namespace isoatlas
