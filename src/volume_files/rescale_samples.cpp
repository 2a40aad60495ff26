// SPDX-License-Identifier: Apache-2.0
#include "volume_files/rescale_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace isoatlas::detail::io {

namespace {

template <class Use>
void with_small_integer(SampleType type, Use use) {
  switch (type) {
    case SampleType::int8:
      return use(std::int8_t{});
    case SampleType::uint8:
      return use(std::uint8_t{});
    case SampleType::int16:
      return use(std::int16_t{});
    case SampleType::uint16:
      return use(std::uint16_t{});
    default:
      throw std::logic_error("only integers of 8 and 16 bits are rescaled here");
  }
}

template <class Use>
void with_result_type(SampleType type, Use use) {
  if (type == SampleType::int32) return use(std::int32_t{});
  if (type == SampleType::float32) return use(float{});
  with_small_integer(type, use);
}

template <class T>
bool holds(double low, double high) {
  return low >= static_cast<double>(std::numeric_limits<T>::min()) &&
         high <= static_cast<double>(std::numeric_limits<T>::max());
}

}  // namespace

SampleType rescaled_type(SampleType stored, double slope, double intercept) {
  if (slope != std::floor(slope) || intercept != std::floor(intercept)) {
    return SampleType::float32;
  }
  double low = 0, high = 0;
  with_small_integer(stored, [&](auto zero) {
    using T = decltype(zero);
    const double a = slope * std::numeric_limits<T>::min() + intercept,
                 b = slope * std::numeric_limits<T>::max() + intercept;
    low = std::min(a, b);
    high = std::max(a, b);
  });
  if (holds<std::uint8_t>(low, high)) return SampleType::uint8;
  if (holds<std::int8_t>(low, high)) return SampleType::int8;
  if (holds<std::uint16_t>(low, high)) return SampleType::uint16;
  if (holds<std::int16_t>(low, high)) return SampleType::int16;
  return holds<std::int32_t>(low, high) ? SampleType::int32 : SampleType::float32;
}

void rescale_samples(SampleType stored, const std::byte* from, std::size_t count, double slope,
                     double intercept, std::byte* to) {
  with_small_integer(stored, [&](auto stored_zero) {
    using Stored = decltype(stored_zero);
    with_result_type(rescaled_type(stored, slope, intercept), [&](auto result_zero) {
      using Result = decltype(result_zero);
      for (std::size_t i = 0; i < count; ++i) {
        Stored value{};
        std::memcpy(&value, from + i * sizeof value, sizeof value);
        const auto result = static_cast<Result>(slope * value + intercept);
        std::memcpy(to + i * sizeof result, &result, sizeof result);
      }
    });
  });
}

}  // namespace isoatlas::detail::io
