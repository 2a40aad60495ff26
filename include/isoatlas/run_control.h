// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <string_view>

#include "isoatlas/export.h"

namespace isoatlas {

/// How a long computation may be watched and stopped. All members are optional.
struct ISOATLAS_API RunControl {
  /// Called from the computing thread now and then: the stage's name and the fraction of the whole
  /// computation that is done, in [0, 1]. The fraction is an estimate; it never falls.
  std::function<void(std::string_view stage, double fraction)> progress;
  /// Set it (from any thread, or from a signal handler) to stop: the computation throws
  /// Error(cancelled) the next time it looks: at least every 7e6 instructions of a thread in white
  /// noise of 16^3, in all stages, which a test counts. In proportion to the volume that is 1.5e9
  /// in 96^3, half a second or a second.
  const std::atomic<bool>* cancel = nullptr;
  /// Number of threads, 0 = as many as the machine has. Results do not depend on it.
  int threads = 0;

  /// Throws Error(cancelled) if the caller asked to stop.
  void check_cancelled() const;
  /// check_cancelled(), then tells `progress`.
  void report(std::string_view stage, double fraction) const;
};

}  // namespace isoatlas
