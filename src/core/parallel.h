// SPDX-License-Identifier: Apache-2.0
// Parallel loops that give the same bytes for any number of threads: every iteration writes only its own slots.
// The only file that knows TBB.
#pragma once

#include <cstddef>
#include <functional>

namespace isoatlas {

/// Limits the threads that parallel loops of the calling thread use while it lives; 0 means as many as the machine has. Other
/// threads of the program, and other users of oneTBB in it, keep theirs. Of nested limits the outermost counts.
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

/// Calls body(begin, end) on pieces of [0, n) of at most `grain` items. Exceptions thrown by a piece reach the caller.
void for_each_piece(std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

}  // namespace isoatlas
