// SPDX-License-Identifier: Apache-2.0
// Long work, called from Python: without the interpreter's lock, watched, and stopped by Ctrl-C
// within a second.
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

/// How work is watched, and what it must not lose.
struct Watch {
  py::object progress = py::none();  ///< called as progress(stage, fraction) on the calling thread,
                                     ///< some 20 times a second; or None
  int threads = 0;                   ///< 0: as many as the machine has
  py::object keep_alive = py::none();  ///< what the work reads without owning it
  std::function<void()> discard = {};  ///< removes what it has half written; called beside it if
                                       ///< the process ends before it does
};

/// Runs `work` on a thread of its own. This one waits without the interpreter's lock, and takes it
/// now and then to look for signals and to call `progress`. What a signal's handler or `progress`
/// raises sets `RunControl::cancel` and is thrown from here.
///
/// Work that does not come back soon after that (a file being read, say) goes on by itself, to no
/// effect, until it looks at `cancel`, or is done, or the process ends. So `work` must own what it
/// uses, `keep_alive` apart, and hold no Python object; and it must look at `cancel` before
/// anything that others would see.
void run_interruptibly(std::function<void(const RunControl&)> work, const Watch& watch);

/// The same for work that makes something. Results are handed over only if the work was not given
/// up.
template <class Work>
auto make_interruptibly(Work work, const Watch& watch) {
  using Result = decltype(work(std::declval<const RunControl&>()));
  const auto result = std::make_shared<std::optional<Result>>();
  run_interruptibly([result, work = std::move(work)](
                        const RunControl& control) { result->emplace(work(control)); },
                    watch);
  return std::move(**result);
}

/// How much work was given up and still goes on.
std::size_t given_up_work();

}  // namespace isoatlas::detail::python
