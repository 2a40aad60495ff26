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

/// The same control, but it reports the fraction of the whole computation instead of that of a stage. The fraction never falls, even if a stage
/// reports less than before. A stage that is not in `stages` counts as part of the stage before it.
RunControl with_whole_progress(const RunControl& control, std::span<const StageShare> stages);

}  // namespace isoatlas
