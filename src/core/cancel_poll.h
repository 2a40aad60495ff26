// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// For loops of short steps, up to some thousand instructions each: tests for cancellation once
/// every kSteps steps.
class CancelPoll {
 public:
  explicit CancelPoll(const RunControl& control) : control_(&control) {}
  explicit CancelPoll(const RunControl* control) : control_(control) {}  ///< none: never stops

  /// Must be called in each step. @throws Error(cancelled)
  void step() {
    if (++steps_ % kSteps == 0 && control_ != nullptr) control_->check_cancelled();
  }

 private:
  static constexpr std::uint32_t kSteps = 512;
  const RunControl* control_;
  std::uint32_t steps_ = 0;
};

}  // namespace isoatlas::detail
