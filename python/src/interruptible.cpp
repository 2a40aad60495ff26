// SPDX-License-Identifier: Apache-2.0
#include "interruptible.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace isoatlas::detail::python {
namespace {

using namespace std::chrono_literals;

constexpr auto kPollInterval = 50ms;  // between two checks for signals
// Time for the work to notice `cancel`. Callers are promised one second in total.
constexpr auto kGracePeriod = 500ms;

struct ProgressReport {
  std::string stage;
  double fraction = 0;
};

/// State that the work and the waiting thread share. Each of them keeps it alive.
struct SharedState {
  std::atomic<bool> cancel{false};
  std::mutex mutex;  // guards all following members
  std::condition_variable changed;
  bool is_done = false;
  std::exception_ptr error;
  /// Progress since the previous poll, one entry per stage: every stage is reported, but Python is
  /// not called for every step.
  std::vector<ProgressReport> reports;

  void report(std::string_view stage, double fraction) {
    const std::lock_guard lock(mutex);
    if (reports.empty() || reports.back().stage != stage)
      reports.push_back({std::string(stage), fraction});
    reports.back().fraction = fraction;
  }

  void finish(std::exception_ptr thrown) {
    const std::lock_guard lock(mutex);
    error = std::move(thrown);
    is_done = true;
    changed.notify_all();
  }
};

struct AbandonedWork {
  std::shared_ptr<SharedState> shared;
  std::thread thread;
  py::object keep_alive;
  std::function<void()> discard;
};

// Guarded by the interpreter's lock. Never destroyed: at the end of the process no interpreter is
// left that could release the Python objects.
std::vector<AbandonedWork>& abandoned() {
  static auto* const list = new std::vector<AbandonedWork>;
  return *list;
}

bool is_done(SharedState& shared) {
  const std::lock_guard lock(shared.mutex);
  return shared.is_done;
}

void remove_finished_work() {
  std::erase_if(abandoned(), [](AbandonedWork& work) {
    if (!is_done(*work.shared)) return false;
    work.thread.join();
    return true;
  });
}

/// An exit handler. A normal exit would destroy static objects that abandoned work still uses, so
/// the process ends here without that. The interpreter has already ended and `status` is final.
void exit_immediately(int status, void* /*unused*/) {
  if (std::ranges::all_of(abandoned(),
                          [](const AbandonedWork& work) { return is_done(*work.shared); }))
    return;
  for (const AbandonedWork& work : abandoned()) {
    if (work.discard && !is_done(*work.shared)) work.discard();
  }
  std::fflush(nullptr);
  _exit(status);
}

void abandon(AbandonedWork work) {
  abandoned().push_back(std::move(work));
  // Registered each time, so that it is called first: handlers run in reverse order.
  on_exit(&exit_immediately, nullptr);
}

/// @return whether the work ended within the grace period
bool cancel(SharedState& shared) {
  shared.cancel = true;
  const py::gil_scoped_release release;
  std::unique_lock lock(shared.mutex);
  return shared.changed.wait_for(lock, kGracePeriod, [&] { return shared.is_done; });
}

}  // namespace

void run_interruptibly(std::function<void(const RunControl&)> work, const RunOptions& options) {
  remove_finished_work();
  const auto shared = std::make_shared<SharedState>();
  const bool reports_progress = !options.progress.is_none();
  std::thread thread(
      [shared, reports_progress, threads = options.threads, work = std::move(work)]() mutable {
        RunControl control{.progress = {}, .cancel = &shared->cancel, .threads = threads};
        if (reports_progress)
          control.progress = [&](std::string_view stage, double fraction) {
            shared->report(stage, fraction);
          };
        std::exception_ptr error;
        try {
          work(control);
        } catch (...) {
          error = std::current_exception();
        }
        work = nullptr;  // releases its resources before the waiting thread continues
        shared->finish(std::move(error));
      });

  try {
    for (bool is_done = false; !is_done;) {
      std::vector<ProgressReport> reports;
      {
        const py::gil_scoped_release release;
        std::unique_lock lock(shared->mutex);
        is_done = shared->changed.wait_for(lock, kPollInterval, [&] { return shared->is_done; });
        reports.swap(shared->reports);
      }
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      for (const ProgressReport& it : reports) options.progress(it.stage, it.fraction);
    }
  } catch (...) {
    if (cancel(*shared))
      thread.join();
    else
      abandon({shared, std::move(thread), options.keep_alive, options.discard});
    throw;
  }
  thread.join();
  if (shared->error) std::rethrow_exception(shared->error);
}

std::size_t abandoned_work_count() {
  remove_finished_work();
  return abandoned().size();
}

}  // namespace isoatlas::detail::python
