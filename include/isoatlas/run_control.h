// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <string_view>

#include "isoatlas/export.h"

namespace isoatlas {

/// Progress, cancellation and threads of a long computation. All members are optional.
struct ISOATLAS_API RunControl {
  /// Called repeatedly from the computing thread with the name of the stage and the fraction of the
  /// whole computation that is done, in [0, 1]. The fraction is an estimate and never decreases.
  std::function<void(std::string_view stage, double fraction)> progress;
  /// Set it to true, from any thread or a signal handler, to cancel the computation. The flag is
  /// read often, and then Error(cancelled) is thrown. A test counts at most 7e6 instructions of a
  /// thread between two reads, in all stages, in white noise of 16^3 samples. For a volume of 96^3
  /// that corresponds to 1.5e9 instructions, half a second to a second.
  const std::atomic<bool>* cancel = nullptr;
  /// Number of threads; 0: as many as the machine has. Results do not depend on it. If it is
  /// negative, functions throw Error(bad_argument).
  int threads = 0;

  /// Throws Error(cancelled) if `cancel` is set.
  void check_cancelled() const;
  /// check_cancelled(), then calls `progress`, if there is one.
  void report(std::string_view stage, double fraction) const;
};

}  // namespace isoatlas
