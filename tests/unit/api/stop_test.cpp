// SPDX-License-Identifier: Apache-2.0
// A cancelled computation ends at its next test of `cancel`, wherever that is. Distances between
// tests: bench/stop_gaps.py.
//
// This program has its own RunControl::check_cancelled() and report(), which count the tests and
// can stop at any of them. They replace those of the library.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "isoatlas/error.h"
#include "isoatlas/extract.h"
#include "support/volumes.h"

namespace isoatlas {
namespace {

std::atomic<int> looks, stop_at;

}  // namespace

void RunControl::check_cancelled() const {
  if (++looks >= stop_at) throw Error(ErrorCode::cancelled, "interrupted");
}

void RunControl::report(std::string_view, double) const { check_cancelled(); }

namespace detail::test {
namespace {

struct Case {
  const char* name;
  Volume volume;
  ExtractOptions options = coarse_options();
};

std::vector<Case> cases() {
  std::vector<Case> out;
  Case& noise = out.emplace_back(
      Case{"noise", to_volume(random_samples(Family::white_noise, {9, 9, 9}, 3)), {}});
  noise.options.refine = {{{Quantity::max_distance, 0.5, true}}, {{Quantity::max_vertices, 2500}}};
  noise.options.measure_samples = 500;
  Case& balls = out.emplace_back(
      Case{"balls",
           to_volume(sampled({16, 16, 16}, unite(sphere({5, 7, 7}, 4.2), sphere({11, 8, 7}, 3.6)))),
           {}});
  balls.options.refine = {{{Quantity::max_distance, 0.1}}};
  balls.options.placement = Placement::balanced;
  balls.options.components.keep_largest = 1;
  Case& tricubic = out.emplace_back(
      Case{"supersampled", to_volume(random_samples(Family::smooth_blobs, {10, 10, 10}, 4)), {}});
  tricubic.options.surface.interpolation = Interpolation::tricubic;
  tricubic.options.supersample = 2;
  tricubic.options.covering.strategy = CoveringStrategy::halving;
  return out;
}

// @return number of tests for cancellation
int run(const Case& c, int threads, int stop) {
  RunControl control;
  control.threads = threads;
  looks = 0;
  stop_at = stop;
  extract(c.volume, c.options, control);
  return looks;
}

constexpr int kNever = 1 << 30, kStops = 60;

TEST(Stop, AtAnyTestForCancellation) {
  for (const Case& c : cases()) {
    const int all = run(c, 1, kNever);
    EXPECT_GT(all, 100) << c.name;
    for (int k = 1; k <= kStops; ++k) {
      const int stop = std::max(1, static_cast<int>(std::int64_t{all} * k / kStops));
      try {
        run(c, 1, stop);
        ADD_FAILURE() << c.name << ": look " << stop << " of " << all << " has not stopped it";
      } catch (const Error& e) {
        ASSERT_EQ(e.code(), ErrorCode::cancelled)
            << c.name << ", look " << stop << ": " << e.what();
      }
      EXPECT_EQ(looks, stop) << c.name << ": it continued";
    }
  }
}

// Each thread may test once more, in pieces of a loop that it has begun, or twice if two loops run
// in parallel.
TEST(Stop, AtAnyTestForCancellationWithThreads) {
  constexpr int kThreads = 3;
  for (const Case& c : cases()) {
    const int all = run(c, kThreads, kNever);
    for (int k = 1; k < kStops / 4; ++k) {
      const int stop = static_cast<int>(std::int64_t{all} * k / (kStops / 4));
      try {
        run(c, kThreads, stop);
        ADD_FAILURE() << c.name << ": look " << stop << " of " << all << " has not stopped it";
      } catch (const Error& e) {
        ASSERT_EQ(e.code(), ErrorCode::cancelled)
            << c.name << ", look " << stop << ": " << e.what();
      }
      EXPECT_LT(looks, stop + 2 * kThreads) << c.name << ": it continued";
    }
  }
}

}  // namespace
}  // namespace detail::test
}  // namespace isoatlas
