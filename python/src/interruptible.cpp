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

constexpr auto kLook = 50ms;    // between looks at signals
constexpr auto kGrace = 500ms;  // for the work to notice `cancel`: what is promised is a second

struct News {
  std::string stage;
  double fraction = 0;
};

/// What the work and who waits for it have in common; it outlives both.
struct Shared {
  std::atomic<bool> cancel{false};
  std::mutex mutex;  // guards what follows
  std::condition_variable changed;
  bool is_done = false;
  std::exception_ptr error;
  std::vector<News> news;  ///< since the last look, one entry per stage: none of them goes unseen,
                           ///< and nobody calls Python a million times

  void tell(std::string_view stage, double fraction) {
    const std::lock_guard lock(mutex);
    if (news.empty() || news.back().stage != stage) news.push_back({std::string(stage), fraction});
    news.back().fraction = fraction;
  }

  void finish(std::exception_ptr thrown) {
    const std::lock_guard lock(mutex);
    error = std::move(thrown);
    is_done = true;
    changed.notify_all();
  }
};

struct GivenUp {
  std::shared_ptr<Shared> shared;
  std::thread thread;
  py::object keep_alive;
  std::function<void()> discard;
};

// Guarded by the interpreter's lock. Never destroyed: at the end of the process there is no
// interpreter to return objects to.
std::vector<GivenUp>& given_up() {
  static auto* const list = new std::vector<GivenUp>;
  return *list;
}

bool is_done(Shared& shared) {
  const std::lock_guard lock(shared.mutex);
  return shared.is_done;
}

void forget_what_has_ended() {
  std::erase_if(given_up(), [](GivenUp& work) {
    if (!is_done(*work.shared)) return false;
    work.thread.join();
    return true;
  });
}

/// What work uses is taken down at the end of the process, under work that still goes on. So the
/// process ends without that; the interpreter is finished by then, and the status known.
void end_at_once(int status, void* /*unused*/) {
  if (std::ranges::all_of(given_up(), [](const GivenUp& work) { return is_done(*work.shared); }))
    return;
  for (const GivenUp& work : given_up()) {
    if (work.discard && !is_done(*work.shared)) work.discard();
  }
  std::fflush(nullptr);
  _exit(status);
}

void give_up(GivenUp work) {
  given_up().push_back(std::move(work));
  on_exit(&end_at_once, nullptr);  // each time: what is registered last is called first
}

/// @return whether the work came back in time
bool cancel(Shared& shared) {
  shared.cancel = true;
  const py::gil_scoped_release release;
  std::unique_lock lock(shared.mutex);
  return shared.changed.wait_for(lock, kGrace, [&] { return shared.is_done; });
}

}  // namespace

void run_interruptibly(std::function<void(const RunControl&)> work, const Watch& watch) {
  forget_what_has_ended();
  const auto shared = std::make_shared<Shared>();
  const bool is_watched = !watch.progress.is_none();
  std::thread thread(
      [shared, is_watched, threads = watch.threads, work = std::move(work)]() mutable {
        RunControl control{.progress = {}, .cancel = &shared->cancel, .threads = threads};
        if (is_watched)
          control.progress = [&](std::string_view stage, double fraction) {
            shared->tell(stage, fraction);
          };
        std::exception_ptr error;
        try {
          work(control);
        } catch (...) {
          error = std::current_exception();
        }
        work = nullptr;  // who waits may use what the work had
        shared->finish(std::move(error));
      });

  try {
    for (bool is_done = false; !is_done;) {
      std::vector<News> news;
      {
        const py::gil_scoped_release release;
        std::unique_lock lock(shared->mutex);
        is_done = shared->changed.wait_for(lock, kLook, [&] { return shared->is_done; });
        news.swap(shared->news);
      }
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      for (const News& item : news) watch.progress(item.stage, item.fraction);
    }
  } catch (...) {
    if (cancel(*shared))
      thread.join();
    else
      give_up({shared, std::move(thread), watch.keep_alive, watch.discard});
    throw;
  }
  thread.join();
  if (shared->error) std::rethrow_exception(shared->error);
}

std::size_t given_up_work() {
  forget_what_has_ended();
  return given_up().size();
}

}  // namespace isoatlas::detail::python
