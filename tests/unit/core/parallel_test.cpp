// SPDX-License-Identifier: Apache-2.0
#include "core/parallel.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "isoatlas/error.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {
namespace {

TEST(ForEachPiece, VisitsEveryItemOnce) {
  for (const int threads : {1, 2, 3, 0}) {
    const ThreadLimit limit(threads);
    for (const std::size_t n : {0u, 1u, 2u, 63u, 64u, 1000u, 12345u}) {
      for (const std::size_t grain : {1u, 7u, 64u, 100000u}) {
        std::vector<std::atomic<int>> visits(n);
        for_each_chunk(n, grain, [&](std::size_t begin, std::size_t end) {
          EXPECT_LT(begin, end);
          EXPECT_LE(end, n);
          for (std::size_t i = begin; i < end; ++i) ++visits[i];
        });
        for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(visits[i], 1) << i << " of " << n;
      }
    }
  }
}

TEST(ForEachPiece, PiecesAreNotLargerThanTheGrain) {
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    std::atomic<std::size_t> largest{0};
    for_each_chunk(100000, 7, [&](std::size_t begin, std::size_t end) {
      std::size_t seen = largest;
      while (end - begin > seen && !largest.compare_exchange_weak(seen, end - begin)) {
      }
    });
    EXPECT_LE(largest, 7u) << threads << " threads";
  }
}

TEST(CollectPieces, KeepsTheOrderOfThePieces) {
  for (const int threads : {1, 2, 0}) {
    const ThreadLimit limit(threads);
    for (const std::size_t grain : {1u, 7u, 100000u}) {
      const auto found = collect_chunks<std::size_t>(
          5000, grain, [](std::size_t begin, std::size_t end, std::vector<std::size_t>& out) {
            for (std::size_t i = begin; i < end; ++i) out.insert(out.end(), i % 3, i);
          });
      std::vector<std::size_t> wanted;
      for (std::size_t i = 0; i < 5000; ++i) wanted.insert(wanted.end(), i % 3, i);
      EXPECT_EQ(found, wanted);
    }
  }
}

TEST(RunBoth, CallsBothAndRethrowsExceptions) {
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    std::atomic<int> calls = 0;
    run_both([&] { calls += 1; }, [&] { calls += 10; });
    EXPECT_EQ(calls, 11);
    const auto fail = [] { throw Error(ErrorCode::bad_file, "this one"); };
    EXPECT_THROW(run_both(fail, [] {}), Error);
    EXPECT_THROW(run_both([] {}, fail), Error);
  }
}

TEST(ThreadLimit, HoldsInNestedLoops) {
  const ThreadLimit limit(2);
  std::mutex mutex;
  std::set<std::thread::id> seen;
  for_each_index(64, 1, [&](std::size_t) {
    const ThreadLimit more(0);  // has no effect: the outer limit applies
    for_each_index(64, 1, [&](std::size_t) {
      const std::lock_guard lock(mutex);
      seen.insert(std::this_thread::get_id());
    });
  });
  EXPECT_LE(seen.size(), 2u);
}

TEST(ForEachPiece, ExceptionsReachTheCaller) {
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    EXPECT_THROW(for_each_chunk(100, 1,
                                [](std::size_t begin, std::size_t) {
                                  if (begin == 41) throw Error(ErrorCode::bad_file, "piece 41");
                                }),
                 Error);
  }
}

TEST(ThreadLimit, OneThreadIsTheCaller) {
  const ThreadLimit limit(1);
  std::mutex mutex;
  std::set<std::thread::id> seen;
  for_each_chunk(1000, 1, [&](std::size_t, std::size_t) {
    const std::lock_guard lock(mutex);
    seen.insert(std::this_thread::get_id());
  });
  EXPECT_EQ(seen, std::set{std::this_thread::get_id()});
}

// Other threads and other users of oneTBB are not affected.
TEST(ThreadLimit, AffectsOnlyTheCallingThread) {
  using tbb::global_control;
  const std::size_t allowed = global_control::active_value(global_control::max_allowed_parallelism);
  const auto threads_in_a_loop = [] {
    int threads = 0;
    for_each_chunk(
        1, 1, [&](std::size_t, std::size_t) { threads = tbb::this_task_arena::max_concurrency(); });
    return threads;
  };
  const ThreadLimit one(1);
  EXPECT_EQ(global_control::active_value(global_control::max_allowed_parallelism), allowed);
  EXPECT_EQ(threads_in_a_loop(), 1);
  std::thread([&] {
    const int all = tbb::info::default_concurrency();  // TBB has no more threads, and prints a
                                                       // warning if more are requested
    const ThreadLimit many(1000);
    EXPECT_EQ(threads_in_a_loop(), all);
    const ThreadLimit nested(1);
    EXPECT_EQ(threads_in_a_loop(), all);
  }).join();
  EXPECT_EQ(threads_in_a_loop(), 1);
}

TEST(ThreadLimit, EndsWithItsScope) {
  const int before = tbb::this_task_arena::max_concurrency();
  { const ThreadLimit limit(before + 1); }
  int threads = 0;
  for_each_chunk(
      1, 1, [&](std::size_t, std::size_t) { threads = tbb::this_task_arena::max_concurrency(); });
  EXPECT_EQ(threads, before);
}

TEST(RunControl, CancelAndProgress) {
  RunControl control;
  EXPECT_NO_THROW(control.check_cancelled());
  EXPECT_NO_THROW(control.report("stage", 0.5));
  std::vector<std::string> reported;
  control.progress = [&](std::string_view stage, double) { reported.emplace_back(stage); };
  std::atomic<bool> cancel{false};
  control.cancel = &cancel;
  control.report("first", 0);
  cancel = true;
  try {
    control.report("second", 1);
    FAIL() << "report() did not notice the flag";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
  EXPECT_EQ(reported, std::vector<std::string>{"first"});
}

}  // namespace
}  // namespace isoatlas::detail
