// SPDX-License-Identifier: Apache-2.0
// The standard's algorithms on whole ranges. libc++ has most of those of std::ranges only from
// version 15 on; these take as many arguments as the core needs, and compile faster.
#pragma once

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

namespace isoatlas::detail::ranges {

/// The order of elements whose projections `less` compares.
template <class Less, class Projection>
auto by_projection(Less less, Projection projection) {
  return [less, projection](const auto& a, const auto& b) {
    return less(std::invoke(projection, a), std::invoke(projection, b));
  };
}

template <class Range, class Less = std::less<>, class Projection = std::identity>
void sort(Range&& range, Less less = {}, Projection projection = {}) {
  std::sort(std::begin(range), std::end(range), by_projection(less, projection));
}

/// Sorts a vector and removes duplicates.
template <class Vector>
void sort_unique(Vector& items) {
  std::sort(items.begin(), items.end());
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

template <class Range, class Less = std::less<>, class Projection = std::identity>
void stable_sort(Range&& range, Less less = {}, Projection projection = {}) {
  std::stable_sort(std::begin(range), std::end(range), by_projection(less, projection));
}

/// Moves the first element of each run with equal projections to the front, as std::unique.
/// @return the end of these
template <class Range, class Projection>
auto unique_by(Range&& range, Projection projection) {
  return std::unique(std::begin(range), std::end(range), [&](const auto& a, const auto& b) {
    return std::invoke(projection, a) == std::invoke(projection, b);
  });
}

template <class Range, class Predicate>
bool all_of(Range&& range, Predicate predicate) {
  return std::all_of(std::begin(range), std::end(range), predicate);
}

template <class Range, class Predicate>
bool any_of(Range&& range, Predicate predicate) {
  return std::any_of(std::begin(range), std::end(range), predicate);
}

template <class Range, class Predicate>
bool none_of(Range&& range, Predicate predicate) {
  return std::none_of(std::begin(range), std::end(range), predicate);
}

template <class Range, class Value>
auto count(Range&& range, const Value& value) {
  return std::count(std::begin(range), std::end(range), value);
}

template <class Range, class Predicate>
auto count_if(Range&& range, Predicate predicate) {
  return std::count_if(std::begin(range), std::end(range), predicate);
}

template <class Range, class Value, class Projection = std::identity>
auto find(Range&& range, const Value& value, Projection projection = {}) {
  return std::find_if(std::begin(range), std::end(range), [&](const auto& element) {
    return std::invoke(projection, element) == value;
  });
}

template <class Range, class Other>
bool equal(Range&& range, Other&& other) {
  return std::equal(std::begin(range), std::end(range), std::begin(other), std::end(other));
}

/// The first element whose projection is not less than `value`, in a range sorted by it.
template <class Range, class Value, class Less = std::less<>, class Projection = std::identity>
auto lower_bound(Range&& range, const Value& value, Less less = {}, Projection projection = {}) {
  return std::lower_bound(std::begin(range), std::end(range), value,
                          [&](const auto& element, const Value& bound) {
                            return less(std::invoke(projection, element), bound);
                          });
}

/// The pair of iterators to the elements with that projection, in a range sorted by it.
template <class Range, class Value, class Projection>
auto equal_range(Range&& range, const Value& value, Projection projection) {
  const auto first = lower_bound(range, value, std::less<>{}, projection);
  auto last = first;
  while (last != std::end(range) && std::invoke(projection, *last) == value) ++last;
  return std::pair(first, last);
}

template <class Range, class Value>
bool binary_search(Range&& range, const Value& value) {
  return std::binary_search(std::begin(range), std::end(range), value);
}

/// @return the end of the output
template <class Range, class Output>
auto copy(Range&& range, Output out) {
  return std::copy(std::begin(range), std::end(range), out);
}

template <class Range, class Output, class Predicate>
auto copy_if(Range&& range, Output out, Predicate predicate) {
  return std::copy_if(std::begin(range), std::end(range), out, predicate);
}

template <class Range, class Output, class Function>
auto transform(Range&& range, Output out, Function function) {
  return std::transform(std::begin(range), std::end(range), out, function);
}

}  // namespace isoatlas::detail::ranges
