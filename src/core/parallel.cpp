// SPDX-License-Identifier: Apache-2.0
#include "core/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <string>
#include <utility>

#include "isoatlas/error.h"

namespace isoatlas::detail {

namespace {

thread_local tbb::task_arena* limited =
    nullptr;  // of this thread's ThreadLimit; null: loops use the current arena

// Threads that work on a loop inherit the limit of the thread that started it.
class InheritedLimit {
 public:
  explicit InheritedLimit(tbb::task_arena* of_loop) : own_(std::exchange(limited, of_loop)) {}
  ~InheritedLimit() { limited = own_; }
  InheritedLimit(const InheritedLimit&) = delete;
  InheritedLimit& operator=(const InheritedLimit&) = delete;

 private:
  tbb::task_arena* own_;
};

}  // namespace

struct ThreadLimit::State {
  tbb::task_arena arena;
};

ThreadLimit::ThreadLimit(int threads) : state_(nullptr) {
  if (threads < 0)
    throw Error(ErrorCode::bad_argument, "the number of threads is " + std::to_string(threads) +
                                             ", expected 0 (all processors) or more");
  if (limited != nullptr) return;
  // TBB has no more workers than this, and prints a warning if more are requested.
  const int max_threads = tbb::info::default_concurrency();
  state_ = new State{tbb::task_arena(threads > 0 ? std::min(threads, max_threads) : max_threads)};
  limited = &state_->arena;
}

ThreadLimit::~ThreadLimit() {
  if (state_ == nullptr) return;
  limited = nullptr;
  delete state_;
}

void for_each_chunk(std::size_t n, std::size_t grain,
                    const std::function<void(std::size_t, std::size_t)>& body) {
  if (n == 0) return;
  const auto loop = [&, limit = limited] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, n, grain),
        [&](const tbb::blocked_range<std::size_t>& r) {
          const InheritedLimit inherited(limit);
          body(r.begin(), r.end());
        },
        tbb::simple_partitioner());
  };
  limited != nullptr ? limited->execute(loop) : loop();
}

void run_both(const std::function<void()>& first, const std::function<void()>& second) {
  for_each_chunk(2, 1, [&](std::size_t begin, std::size_t end) {
    if (begin == 0) first();
    if (end == 2) second();
  });
}

}  // namespace isoatlas::detail
