// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace isoatlas::detail::tool {

/// Keeps the last few results for pages to fetch. Thread-safe.
template <class Result>
class KeptResults {
 public:
  explicit KeptResults(std::size_t most) : most_(most) {}

  /// @return the number under which it is kept
  std::uint64_t keep(Result result) {
    const std::lock_guard lock(mutex_);
    results_.push_back(std::move(result));
    if (results_.size() > most_) {
      results_.pop_front();
      ++first_;
    }
    return first_ + results_.size() - 1;
  }

  /// None if there is no such result, or not any more.
  std::optional<Result> get(std::uint64_t number) const {
    const std::lock_guard lock(mutex_);
    if (number < first_ || number - first_ >= results_.size()) return std::nullopt;
    return results_[number - first_];
  }

 private:
  std::size_t most_;
  mutable std::mutex mutex_;
  std::deque<Result> results_;
  std::uint64_t first_ = 0;
};

}  // namespace isoatlas::detail::tool
