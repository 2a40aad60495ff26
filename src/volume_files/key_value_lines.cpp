// SPDX-License-Identifier: Apache-2.0
#include "volume_files/key_value_lines.h"

#include <algorithm>
#include <cmath>

#include "files/number_text.h"

namespace isoatlas::detail::io {

KeyValueLines::KeyValueLines(std::string_view text) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (const std::size_t sign = line.find('='); sign != std::string_view::npos) {
      values_.insert_or_assign(std::string(line.substr(0, sign)),
                               std::string(line.substr(sign + 1)));
    }
  }
}

std::string KeyValueLines::text(const std::string& key) const {
  const auto found = values_.find(key);
  return found == values_.end() ? "" : found->second;
}

std::optional<double> finite_number(std::string_view text) {
  constexpr std::string_view kSpaces = " \t";
  text.remove_prefix(std::min(text.find_first_not_of(kSpaces), text.size()));
  text = text.substr(0, text.find_last_not_of(kSpaces) + 1);
  double number = 0;
  return parse_number(text, number) && std::isfinite(number) ? std::optional(number) : std::nullopt;
}

std::optional<std::size_t> count_of_pages(std::string_view text) {
  const std::optional<double> number = finite_number(text);
  constexpr double kMost = 1e6;  // the product of three such counts fits in 64 bits
  return number && *number >= 1 && *number <= kMost
             ? std::optional(static_cast<std::size_t>(*number))
             : std::nullopt;
}

}  // namespace isoatlas::detail::io
