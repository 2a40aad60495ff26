// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iterator>
#include <vector>

namespace isoatlas::detail {

/// Appends to a large array and grows its capacity by at most a sixteenth more than needed: these
/// arrays rarely grow, and doubling the largest ones would determine the peak of memory.
template <class T, class Iterator>
void append(std::vector<T>& to, Iterator first, Iterator last) {
  const std::size_t needed = to.size() + static_cast<std::size_t>(std::distance(first, last));
  if (needed > to.capacity()) to.reserve(needed + needed / 16);
  to.insert(to.end(), first, last);
}

}  // namespace isoatlas::detail
