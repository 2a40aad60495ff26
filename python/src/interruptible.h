// SPDX-License-Identifier: Apache-2.0
// Long computations, called from Python: they run without the interpreter's lock, report progress,
// and end within a second after Ctrl-C.
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "isoatlas/run_control.h"

namespace isoatlas::detail::python {

namespace py = pybind11;

/// How a computation runs, and the resources it needs until its end.
struct RunOptions {
  /// Called as progress(stage, fraction) on the calling thread, about 20 times a second; or None.
  py::object progress = py::none();
  int threads = 0;  ///< 0: as many as the machine has
  /// An object whose memory the work reads without owning it.
  py::object keep_alive = py::none();
  /// Removes incomplete files. Called concurrently with the work if the process ends first.
  std::function<void()> discard = {};
};

/// Runs `work` on a new thread. The calling thread waits without the interpreter's lock; about 20
/// times a second it takes the lock, handles signals and calls `progress`. If a signal handler or
/// `progress` raises an exception, `RunControl::cancel` is set and the exception is thrown.
///
/// Work that does not end soon after that, such as reading a large file, is abandoned: it runs
/// until it checks `cancel`, or is done, or the process ends, and its result is dropped. So `work`
/// must own everything it uses except `keep_alive`, must not contain a Python object, and must
/// check `cancel` before each effect that is visible outside.
/// @throws the error of `work`; py::error_already_set for a signal handler or `progress`
void run_interruptibly(std::function<void(const RunControl&)> work, const RunOptions& options);

/// Like run_interruptibly(), and returns the result of `work`.
template <class Work>
auto compute_interruptibly(Work work, const RunOptions& options) {
  using Result = decltype(work(std::declval<const RunControl&>()));
  const auto result = std::make_shared<std::optional<Result>>();
  run_interruptibly([result, work = std::move(work)](
                        const RunControl& control) { result->emplace(work(control)); },
                    options);
  return std::move(**result);
}

/// Number of abandoned computations that are still running.
std::size_t abandoned_work_count();

}  // namespace isoatlas::detail::python
