// SPDX-License-Identifier: Apache-2.0
#include "nearest_name.h"

#include <algorithm>
#include <vector>

#include "wording/values.h"

namespace isoatlas::detail::tool {

// Optimal string alignment: Levenshtein distance with swaps, keeping the last three rows of the
// table.
std::size_t edit_distance(std::string_view from, std::string_view to) {
  std::vector<std::size_t> before_last(to.size() + 1), last(to.size() + 1), row(to.size() + 1);
  for (std::size_t j = 0; j <= to.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= from.size(); ++i) {
    before_last.swap(last);
    last.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= to.size(); ++j) {
      row[j] =
          std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (from[i - 1] == to[j - 1] ? 0 : 1)});
      const bool is_swap = i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1];
      if (is_swap) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[to.size()];
}

std::string nearest_name(std::string_view typed, std::span<const std::string> names) {
  constexpr std::size_t kShortestBeginning = 3;
  const std::string plain = plain_word(typed);
  std::string nearest, begun;
  std::size_t smallest = std::max<std::size_t>(1, plain.size() / 3) + 1, beginnings = 0;
  for (const std::string& name : names) {
    const std::size_t distance = edit_distance(plain, plain_word(name));
    if (distance < smallest && distance < name.size()) {
      smallest = distance;
      nearest = name;
    }
    if (plain.size() >= kShortestBeginning && plain_word(name).starts_with(plain)) {
      begun = name;
      ++beginnings;
    }
  }
  return smallest > 1 && beginnings == 1 ? begun : nearest;
}

}  // namespace isoatlas::detail::tool
