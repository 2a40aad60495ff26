// SPDX-License-Identifier: Apache-2.0
#include "core/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <algorithm>
#include <thread>

namespace isoatlas {

struct ThreadLimit::State {
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads)
    : state_(new State{
          tbb::global_control(tbb::global_control::max_allowed_parallelism,
                              threads > 0 ? static_cast<std::size_t>(threads) : std::max(1u, std::thread::hardware_concurrency()))}) {}

ThreadLimit::~ThreadLimit() { delete state_; }

void for_each_piece(std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  if (n == 0) return;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, n, grain), [&](const tbb::blocked_range<std::size_t>& r) { body(r.begin(), r.end()); },
      tbb::simple_partitioner());
}

}  // namespace isoatlas
