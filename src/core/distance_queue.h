// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

namespace isoatlas::detail {

/// Heaps of (length, id) with a total order: by length, then by the smaller id. One 64-bit
/// comparison suffices, since the bit patterns of non-negative floats are ordered like the floats.
inline std::uint64_t length_key(float length, std::uint32_t id) {
  return static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(length)) << 32 | id;
}
inline float key_length(std::uint64_t key) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32));
}
inline std::uint32_t key_id(std::uint64_t key) { return static_cast<std::uint32_t>(key); }

/// Binary heap of such keys; clear() keeps the memory for reuse.
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

/// A radix heap: pops the smallest length, ties in an order that depends on the pushes alone. For
/// searches whose lengths never decrease: no pushed length may be smaller than the last one popped.
/// Faster than a binary heap with many keys.
/// @source Ahuja, Mehlhorn, Orlin, Tarjan, Faster algorithms for the shortest path problem, 1990
class MonotoneQueue {
 public:
  bool empty() const { return size_ == 0; }
  void clear() {
    for (std::vector<std::uint64_t>& keys : buckets_) keys.clear();
    size_ = 0;
    last_ = 0;
  }
  void push(std::uint64_t key) {
    buckets_[bucket_of(key)].push_back(key);
    ++size_;
  }
  std::uint64_t pop() {
    std::vector<std::uint64_t>& shortest = buckets_[0];
    if (shortest.empty()) refill();
    const std::uint64_t key = shortest.back();
    shortest.pop_back();
    --size_;
    return key;
  }

 private:
  static std::uint32_t bits_of(std::uint64_t key) { return static_cast<std::uint32_t>(key >> 32); }
  // The bucket of a key is the highest bit in which its length differs from the last one popped:
  // all lengths in a bucket are smaller than those in the next.
  std::size_t bucket_of(std::uint64_t key) const {
    return static_cast<std::size_t>(std::bit_width(bits_of(key) ^ last_));
  }

  void refill() {
    const auto next = std::find_if(buckets_.begin() + 1, buckets_.end(),
                                   [](const auto& keys) { return !keys.empty(); });
    last_ = bits_of(*std::min_element(next->begin(), next->end()));
    for (const std::uint64_t key : *next)
      buckets_[bucket_of(key)].push_back(key);  // into earlier ones
    next->clear();
  }

  std::array<std::vector<std::uint64_t>, 33> buckets_;
  std::size_t size_ = 0;
  std::uint32_t last_ = 0;  // bits of the length that was popped last
};

using NearestFirst = KeyHeap<std::greater<>>;  ///< pops the smallest length, ties by the smaller id
using FarthestFirst =
    KeyHeap<std::less<>>;  ///< pops the largest; store ~id for ties by the smaller id

}  // namespace isoatlas::detail
