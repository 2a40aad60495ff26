// SPDX-License-Identifier: Apache-2.0
// Numbers in the text of files: the same in every locale, and as people write them.
#pragma once

#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace isoatlas::detail::io {

/// Reads the number that `text` begins with, as std::from_chars does. A plus sign may stand before
/// it, and a number too small for the type becomes 0: "1e-400" is 0, "1e400" is an error. The
/// result's `ptr` is behind the number.
template <class Number>
std::from_chars_result leading_number(std::string_view text, Number& value) {
  const char* const end = text.data() + text.size();
  if (text.starts_with('+') && !text.starts_with("+-")) {
    text.remove_prefix(1);  // from_chars takes no plus sign
  }
  std::from_chars_result result = std::from_chars(text.data(), end, value);
  if constexpr (std::is_floating_point_v<Number>) {
    long double wide = 0;  // has more bits in its exponent
    if (result.ec == std::errc::result_out_of_range &&
        std::from_chars(text.data(), end, wide).ec == std::errc{} && std::fabs(wide) < 1) {
      value = static_cast<Number>(wide);
      result.ec = std::errc{};
    }
  }
  return result;
}

/// True if all of `word` is one number.
template <class Number>
bool parse_number(std::string_view word, Number& value) {
  const auto [end, error] = leading_number(word, value);
  return error == std::errc{} && end == word.data() + word.size();
}

}  // namespace isoatlas::detail::io
