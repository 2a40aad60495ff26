// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/ids.h"

namespace isoatlas::detail {

/// Which way the closed components of a surface face, and which of them lies in which. Components with a boundary enclose nothing.
struct Nesting {
  std::vector<std::int8_t> facing;    ///< per component: 1 outward, -1 inward (around a cavity), 0 neither: open, or without volume
  std::vector<std::uint32_t> parent;  ///< per component: the innermost one that encloses it; kNone: none does, or it is open
  friend bool operator==(const Nesting&, const Nesting&) = default;
};

/// Per component, 1 if it faces otherwise or lies in another component than in `wanted`.
inline std::vector<std::uint8_t> differences(const Nesting& nesting, const Nesting& wanted) {
  std::vector<std::uint8_t> differ(wanted.facing.size(), 0);
  for (std::size_t c = 0; c < differ.size(); ++c) {
    differ[c] = nesting.facing[c] != wanted.facing[c] || nesting.parent[c] != wanted.parent[c] ? 1 : 0;
  }
  return differ;
}

/// What is left of a nesting when some components are dropped. The others keep their order; they lie in the innermost one that is left.
/// @param dropped  per component, 1 if it goes
inline Nesting without(const Nesting& nesting, std::span<const std::uint8_t> dropped) {
  std::vector<std::uint32_t> now(dropped.size(), kNone);
  std::uint32_t kept = 0;
  for (std::size_t c = 0; c < dropped.size(); ++c) {
    if (dropped[c] == 0) now[c] = kept++;
  }
  Nesting out;
  for (std::size_t c = 0; c < dropped.size(); ++c) {
    if (dropped[c] != 0) continue;
    std::uint32_t parent = nesting.parent[c];
    while (parent != kNone && dropped[parent] != 0) parent = nesting.parent[parent];
    out.facing.push_back(nesting.facing[c]);
    out.parent.push_back(parent == kNone ? kNone : now[parent]);
  }
  return out;
}

/// The parents in a nesting that is known as the set of all components around each.
/// @param around  per component, those that enclose it, in any order
inline std::vector<std::uint32_t> parents_of(std::span<const std::vector<std::uint32_t>> around) {
  std::vector<std::uint32_t> parent(around.size(), kNone);
  for (std::size_t c = 0; c < around.size(); ++c) {
    for (const std::uint32_t outer : around[c]) {  // the innermost has the most around it
      std::uint32_t& best = parent[c];
      if (best == kNone || around[outer].size() > around[best].size() || (around[outer].size() == around[best].size() && outer < best))
        best = outer;
    }
  }
  return parent;
}

}  // namespace isoatlas::detail
