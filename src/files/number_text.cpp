// SPDX-License-Identifier: Apache-2.0
#include "files/number_text.h"

#include <algorithm>

namespace isoatlas::detail::io {

namespace {

constexpr std::int64_t kExponentLimit = 1'000'000'000'000'000;  // no text has so many digits

// Removes the digits at the beginning of `text` and returns them.
std::string_view take_digits(std::string_view& text) {
  const std::size_t count =
      std::min(text.find_first_not_of("0123456789"), text.size());  // npos: all are digits
  const std::string_view digits = text.substr(0, count);
  text.remove_prefix(count);
  return digits;
}

bool take(std::string_view& text, char c) {
  if (!text.starts_with(c)) {
    return false;
  }
  text.remove_prefix(1);
  return true;
}

}  // namespace

std::optional<Decimal> split_decimal(std::string_view text) {
  Decimal number;
  number.is_negative = !take(text, '+') && take(text, '-');
  number.whole = take_digits(text);
  if (take(text, '.')) {
    number.fraction = take_digits(text);
  }
  if (number.whole.empty() && number.fraction.empty()) {
    return std::nullopt;
  }
  if (take(text, 'e') || take(text, 'E')) {
    const bool is_negative = !take(text, '+') && take(text, '-');
    const std::string_view digits = take_digits(text);
    if (digits.empty()) {
      return std::nullopt;
    }
    std::int64_t exponent = 0;
    const std::errc error =
        std::from_chars(digits.data(), digits.data() + digits.size(), exponent).ec;
    exponent = error == std::errc{} ? std::min(exponent, kExponentLimit) : kExponentLimit;
    number.exponent = is_negative ? -exponent : exponent;
  }
  if (!text.empty()) {
    return std::nullopt;
  }
  return number;
}

bool Decimal::is_below_one() const {
  const std::size_t in_whole = whole.find_first_not_of('0');
  if (in_whole != std::string_view::npos) {
    return static_cast<std::int64_t>(whole.size() - in_whole) + exponent <= 0;
  }
  const std::size_t in_fraction = fraction.find_first_not_of('0');
  return in_fraction == std::string_view::npos ||
         exponent <= static_cast<std::int64_t>(in_fraction);
}

std::optional<std::uint64_t> Decimal::integer_magnitude() const {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();
  // The exponent moves the decimal point to behind this many of the digits.
  const std::int64_t point = static_cast<std::int64_t>(whole.size()) + exponent;
  std::uint64_t magnitude = 0;
  std::int64_t digits_read = 0;
  for (const std::string_view digits : {whole, fraction}) {
    for (const char c : digits) {
      const auto digit = static_cast<std::uint64_t>(c - '0');
      if (digits_read++ >= point) {
        if (digit != 0) {
          return std::nullopt;  // a fraction is left
        }
        continue;
      }
      if (magnitude > (kMost - digit) / 10) {
        return std::nullopt;
      }
      magnitude = 10 * magnitude + digit;
    }
  }
  for (; digits_read < point && magnitude != 0; ++digits_read) {
    if (magnitude > kMost / 10) {
      return std::nullopt;
    }
    magnitude *= 10;
  }
  return magnitude;
}

}  // namespace isoatlas::detail::io
