// SPDX-License-Identifier: Apache-2.0
// Parallel loops that give the same bytes for any number of threads: every iteration writes only
// its own slots. The only file that includes oneTBB is parallel.cpp.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// Limits the number of threads that parallel loops of the calling thread use during its lifetime;
/// 0 means as many as the machine has. Other threads of the program, and other users of oneTBB in
/// it, are not affected. Of nested limits the outermost one applies.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct State;
  State* state_;
};

/// Calls body(begin, end) on chunks of [0, n) of at most `grain` items. Exceptions thrown by a
/// chunk reach the caller.
void for_each_chunk(std::size_t n, std::size_t grain,
                    const std::function<void(std::size_t, std::size_t)>& body);

/// Calls both, in parallel if a thread is free. Neither may depend on the other.
void run_both(const std::function<void()>& first, const std::function<void()>& second);

/// Calls body(i) for each i in [0, n), in chunks of at most `grain`.
template <class Body>
void for_each_index(std::size_t n, std::size_t grain, const Body& body) {
  for_each_chunk(n, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

/// The same; each chunk tests for cancellation before it begins. @param control  none: never
/// cancelled
template <class Body>
void for_each_index(std::size_t n, std::size_t grain, const RunControl* control, const Body& body) {
  for_each_chunk(n, grain, [&](std::size_t begin, std::size_t end) {
    if (control != nullptr) control->check_cancelled();
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

/// Concatenates the items that collect(begin, end, out) appends for chunks of [0, n), in the order
/// of the chunks; the result does not depend on the number of threads.
template <class Item, class Collect>
std::vector<Item> collect_chunks(std::size_t n, std::size_t grain, const Collect& collect) {
  std::vector<std::vector<Item>> found((n + grain - 1) / grain);
  for_each_index(found.size(), 1, [&](std::size_t chunk) {
    collect(chunk * grain, std::min(n, (chunk + 1) * grain), found[chunk]);
  });
  std::size_t count = 0;
  for (const auto& part : found) count += part.size();
  std::vector<Item> out;
  out.reserve(count);
  for (auto& part : found) {
    out.insert(out.end(), part.begin(), part.end());
    part = {};
  }
  return out;
}

}  // namespace isoatlas::detail
