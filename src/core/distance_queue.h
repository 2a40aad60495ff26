// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

namespace isoatlas {

/// Heaps of (length, id) with a total order: by length, then by the smaller id. One 64-bit comparison, since the bit
/// patterns of non-negative floats order as the floats do.
inline std::uint64_t length_key(float length, std::uint32_t id) {
  return static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(length)) << 32 | id;
}
inline float key_length(std::uint64_t key) { return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32)); }
inline std::uint32_t key_id(std::uint64_t key) { return static_cast<std::uint32_t>(key); }

/// Binary heap over such keys; the storage survives clear(), so that it costs nothing to use again.
template <class Compare>
class KeyHeap {
 public:
  bool empty() const { return keys_.empty(); }
  std::size_t size() const { return keys_.size(); }
  std::uint64_t top() const { return keys_.front(); }
  void clear() { keys_.clear(); }
  void push(std::uint64_t key) {
    keys_.push_back(key);
    std::push_heap(keys_.begin(), keys_.end(), Compare{});
  }
  std::uint64_t pop() {
    std::pop_heap(keys_.begin(), keys_.end(), Compare{});
    const std::uint64_t key = keys_.back();
    keys_.pop_back();
    return key;
  }

 private:
  std::vector<std::uint64_t> keys_;
};

using NearestFirst = KeyHeap<std::greater<>>;  ///< pops the smallest length, ties by the smaller id
using FarthestFirst = KeyHeap<std::less<>>;    ///< pops the largest; store ~id for ties by the smaller id

}  // namespace isoatlas
