// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iterator>
#include <vector>

namespace isoatlas {

/// Appends to an array of the whole surface. It grows to what it needs and a little more: to double the largest arrays would be the peak of
/// memory, and they grow seldom.
template <class T, class Iterator>
void append(std::vector<T>& to, Iterator first, Iterator last) {
  const std::size_t needed = to.size() + static_cast<std::size_t>(std::distance(first, last));
  if (needed > to.capacity()) to.reserve(needed + needed / 16);
  to.insert(to.end(), first, last);
}

}  // namespace isoatlas
