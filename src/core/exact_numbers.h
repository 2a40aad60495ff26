// SPDX-License-Identifier: Apache-2.0
// Samples without rounding, and two kinds of numbers to compute signs with: doubles with a bound of
// their error, which nearly always suffice, and integers as long as necessary.
#pragma once

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cfloat>
#include <climits>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace isoatlas::detail {

/// A double or a 64-bit integer: exactly `high` + `low`.
struct ExactSample {
  double high = 0, low = 0;

  ExactSample() = default;
  ExactSample(double value) : high(value) {}
  ExactSample(double h, double l) : high(h), low(l) {}
  template <std::integral T>
  ExactSample(T value) {
    // The part without the last 12 bits has at most 52, so both fit.
    const T upper = static_cast<T>(sizeof(T) < 8 ? value : value / 4096 * 4096);
    high = static_cast<double>(upper);
    low = static_cast<double>(value - upper);
  }
  ExactSample operator-() const { return {-high, -low}; }
};

/// A number and a bound of its error. The bounds use twice the unit of rounding, which more than
/// compensates for their own rounding. A value that is not finite, or so small that a product may
/// have lost all digits, decides nothing.
struct Rounded {
  double value = 0, error = 0;

  Rounded() = default;
  Rounded(double v, double e)
      : value(v), error(e + DBL_EPSILON * (std::fabs(v) + e) + kUnderflow) {}

  friend Rounded operator+(Rounded a, Rounded b) { return {a.value + b.value, a.error + b.error}; }
  friend Rounded operator-(Rounded a, Rounded b) { return {a.value - b.value, a.error + b.error}; }
  friend Rounded operator*(Rounded a, Rounded b) {
    return {a.value * b.value,
            std::fabs(a.value) * b.error + std::fabs(b.value) * a.error + a.error * b.error};
  }

 private:
  static constexpr double kUnderflow = DBL_MIN;
};

/// The difference of two samples.
inline Rounded rounded_difference(const ExactSample& a, const ExactSample& b) {
  return Rounded(a.high - b.high, 0) + Rounded(a.low - b.low, 0);
}

/// The sign, -1 or 1; nothing if it is within the error.
inline std::optional<int> sign_of(const Rounded& x) {
  if (std::fabs(x.value) > x.error && std::isfinite(x.value)) return x.value > 0 ? 1 : -1;
  return {};
}

using Integer = boost::multiprecision::cpp_int;

inline std::optional<int> sign_of(const Integer& x) { return x.sign(); }

/// The samples as integers, all times the same power of two.
template <std::size_t n>
std::array<Integer, n> common_integers(const std::array<ExactSample, n>& samples) {
  int least = INT_MAX;
  for (const ExactSample& sample : samples) {
    for (const double part : {sample.high, sample.low}) {
      int exponent = 0;
      std::frexp(part, &exponent);
      if (part != 0) least = std::min(least, exponent - DBL_MANT_DIG);
    }
  }
  const auto integer = [&](double part) {
    int exponent = 0;
    const double mantissa = std::frexp(part, &exponent);
    if (part == 0) return Integer(0);
    const auto whole = static_cast<std::int64_t>(std::ldexp(mantissa, DBL_MANT_DIG));
    return Integer(Integer(whole) << static_cast<unsigned>(exponent - DBL_MANT_DIG - least));
  };
  std::array<Integer, n> out;
  for (std::size_t i = 0; i < n; ++i) out[i] = integer(samples[i].high) + integer(samples[i].low);
  return out;
}

}  // namespace isoatlas::detail
