// SPDX-License-Identifier: Apache-2.0
// Numbers in the text of files: read the same in every locale, and as people write them.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace isoatlas::detail::io {

/// The digits of a decimal number such as "-12.50e3": (whole.fraction) * 10^exponent. The views
/// point into the text.
struct Decimal {
  bool is_negative = false;
  std::string_view whole, fraction;  ///< digits before and after the decimal point
  std::int64_t exponent = 0;         ///< limited to -10^15 .. 10^15

  /// True if the number is zero or its first digit that is not 0 is after the decimal point.
  bool is_below_one() const;

  /// The number without its sign, or nothing if it is not an integer or does not fit. Computed with
  /// integers only, so it is exact.
  std::optional<std::uint64_t> integer_magnitude() const;
};

/// Splits `text`, all of which must be one decimal number as std::from_chars takes it; a plus sign
/// may precede it. Nothing for other text: "inf", "nan" and hexadecimal numbers.
std::optional<Decimal> split_decimal(std::string_view text);

/// Reads the number at the beginning of `text`, as std::from_chars does. A plus sign may precede
/// it, and a number too small for the type becomes 0: "1e-400" is 0, "1e400" is an error. The
/// result's `ptr` points behind the number.
///
/// The text is converted directly to `Number` and so rounded once; no wider type is involved, which
/// would differ between platforms.
template <class Number>
std::from_chars_result leading_number(std::string_view text, Number& value) {
  if (text.starts_with('+') && !text.starts_with("+-")) {
    text.remove_prefix(1);  // from_chars takes no plus sign
  }
  std::from_chars_result result = std::from_chars(text.data(), text.data() + text.size(), value);
  if constexpr (std::is_floating_point_v<Number>) {
    if (result.ec == std::errc::result_out_of_range) {
      // from_chars does not report whether the number is too large or too small: the digits do.
      const auto length = static_cast<std::size_t>(result.ptr - text.data());
      const std::optional<Decimal> number = split_decimal(text.substr(0, length));
      if (number && number->is_below_one()) {
        value = number->is_negative ? -Number{0} : Number{0};
        result.ec = std::errc{};
      }
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

/// Reads an integer that may also be written like 3.0, 1e3 or -0. False if it is not an integer, or
/// out of the type's range. Every value of the type is read exactly, up to 64 bits: no
/// floating-point number is involved.
template <class Integer>
bool parse_integer_in_decimal(std::string_view word, Integer& value) {
  static_assert(std::is_integral_v<Integer>);
  const std::optional<Decimal> number = split_decimal(word);
  const std::optional<std::uint64_t> magnitude =
      number ? number->integer_magnitude() : std::nullopt;
  if (!magnitude) {
    return false;
  }
  // The smallest signed value is -(largest + 1), the smallest unsigned one is 0.
  using Limits = std::numeric_limits<Integer>;
  const auto largest = static_cast<std::uint64_t>(Limits::max());
  const std::uint64_t smallest_magnitude = Limits::is_signed ? largest + 1 : 0;
  if (*magnitude > (number->is_negative ? smallest_magnitude : largest)) {
    return false;
  }
  value = static_cast<Integer>(number->is_negative ? std::uint64_t{0} - *magnitude : *magnitude);
  return true;
}

}  // namespace isoatlas::detail::io
