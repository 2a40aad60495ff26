// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace isoatlas::detail {

/// A set of small integers that is cleared in constant time, for repeated use. Inserting grows it
/// as needed.
class EpochSet {
 public:
  void clear() {
    if (++epoch_ != 0) return;
    std::fill(stamps_.begin(), stamps_.end(), 0u);  // once in 2^32 calls
    epoch_ = 1;
  }
  /// @return false if it was already contained
  bool insert(std::uint32_t i) {
    if (i >= stamps_.size())
      stamps_.resize(std::max<std::size_t>(std::size_t{i} + 1, 2 * stamps_.size()), 0);
    if (stamps_[i] == epoch_) return false;
    stamps_[i] = epoch_;
    return true;
  }
  bool contains(std::uint32_t i) const { return i < stamps_.size() && stamps_[i] == epoch_; }

 private:
  std::vector<std::uint32_t> stamps_;  // the epoch in which each integer was last inserted
  std::uint32_t epoch_ = 1;
};

}  // namespace isoatlas::detail
