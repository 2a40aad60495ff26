// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/ids.h"

namespace isoatlas::detail {

/// The orientation of the closed components of a surface, and which of them lies inside which.
/// Components with a boundary enclose nothing.
struct Nesting {
  /// the orientation per component: 1 outward, -1 inward (it bounds a cavity), 0 undefined (it is
  /// open or has no volume)
  std::vector<std::int8_t> facing;
  std::vector<std::uint32_t> parent;  ///< per component: the innermost one that encloses it; kNone
                                      ///< if no component encloses it, or if it is open
  friend bool operator==(const Nesting&, const Nesting&) = default;
};

/// Per component, 1 if its orientation or its parent differs from `wanted`.
inline std::vector<std::uint8_t> differences(const Nesting& nesting, const Nesting& wanted) {
  std::vector<std::uint8_t> differ(wanted.facing.size(), 0);
  for (std::size_t c = 0; c < differ.size(); ++c) {
    differ[c] =
        nesting.facing[c] != wanted.facing[c] || nesting.parent[c] != wanted.parent[c] ? 1 : 0;
  }
  return differ;
}

/// The nesting without some components. The others keep their order; their parent is the innermost
/// remaining one.
/// @param dropped  per component, 1 if it is removed
inline Nesting without(const Nesting& nesting, std::span<const std::uint8_t> dropped) {
  std::vector<std::uint32_t> new_id(dropped.size(), kNone);
  std::uint32_t kept = 0;
  for (std::size_t c = 0; c < dropped.size(); ++c) {
    if (dropped[c] == 0) new_id[c] = kept++;
  }
  Nesting out;
  for (std::size_t c = 0; c < dropped.size(); ++c) {
    if (dropped[c] != 0) continue;
    std::uint32_t parent = nesting.parent[c];
    while (parent != kNone && dropped[parent] != 0) parent = nesting.parent[parent];
    out.facing.push_back(nesting.facing[c]);
    out.parent.push_back(parent == kNone ? kNone : new_id[parent]);
  }
  return out;
}

/// Computes the parents from the sets of enclosing components.
/// @param enclosing  per component, those that enclose it, in any order
inline std::vector<std::uint32_t> parents_of(
    std::span<const std::vector<std::uint32_t>> enclosing) {
  std::vector<std::uint32_t> parent(enclosing.size(), kNone);
  for (std::size_t c = 0; c < enclosing.size(); ++c) {
    for (const std::uint32_t outer :
         enclosing[c]) {  // the innermost one has the most enclosing components
      std::uint32_t& best = parent[c];
      if (best == kNone || enclosing[outer].size() > enclosing[best].size() ||
          (enclosing[outer].size() == enclosing[best].size() && outer < best))
        best = outer;
    }
  }
  return parent;
}

}  // namespace isoatlas::detail
