// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

namespace isoatlas::detail {

/// Union-find whose roots are the smallest members, so that they do not depend on the order of
/// unions. Several threads may call unite() and find() at the same time; the results of find() are
/// final once all calls of unite() have returned.
///
/// @source Anderson and Woll, Wait-free parallel algorithms for the union-find problem, 1991: the
///         parent of a member only ever becomes a smaller member of the same set, and sets are only
///         joined to roots, by compare and swap
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) {
    for (std::uint32_t i = 0; i < n; ++i) set_parent(i, i);
  }

  std::uint32_t find(std::uint32_t i) {
    for (std::uint32_t parent = parent_of(i); parent != i; parent = parent_of(i)) {
      const std::uint32_t grandparent = parent_of(parent);
      if (grandparent == parent) return parent;
      set_parent(i, grandparent);
      i = grandparent;
    }
    return i;
  }

  void unite(std::uint32_t a, std::uint32_t b) {
    while (parent_of(a) != parent_of(b)) {
      a = find(a);
      b = find(b);
      if (a == b) return;
      if (b < a) std::swap(a, b);
      std::uint32_t root = b;
      if (parent_[b].compare_exchange_strong(root, a, std::memory_order_relaxed)) return;
    }
  }

  bool is_root(std::uint32_t i) const { return parent_of(i) == i; }

  /// Makes i a set of its own; only valid if every member of its set is reset.
  void reset(std::uint32_t i) { set_parent(i, i); }

 private:
  std::uint32_t parent_of(std::uint32_t i) const {
    return parent_[i].load(std::memory_order_relaxed);
  }
  void set_parent(std::uint32_t i, std::uint32_t parent) {
    parent_[i].store(parent, std::memory_order_relaxed);
  }

  std::vector<std::atomic<std::uint32_t>> parent_;
};

}  // namespace isoatlas::detail
