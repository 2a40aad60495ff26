// SPDX-License-Identifier: Apache-2.0
// Converts stored values to samples in memory: selects one of several values, unpacks bits, and
// converts half precision.
#include <bit>
#include <cstring>

#include "volume_files/tiff_file.h"

namespace isoatlas::detail::io {

namespace {

float from_half(std::uint16_t half) {
  const std::uint32_t sign = (half & 0x8000U) << 16;
  const std::uint32_t exponent = half >> 10 & 0x1FU;
  const std::uint32_t fraction = half & 0x3FFU;
  if (exponent == 0) {  // zero or subnormal: fraction / 2^24
    const float magnitude = static_cast<float>(fraction) * 0x1p-24F;
    return sign == 0 ? magnitude : -magnitude;
  }
  const std::uint32_t float_exponent = exponent == 31 ? 255 : exponent + 112;
  return std::bit_cast<float>(sign | float_exponent << 23 | fraction << 13);
}

// Bits run from the highest of a byte to the lowest, in both byte orders.
std::uint16_t bits_at(const std::byte* stored, std::uint64_t first_bit, unsigned count) {
  unsigned value = 0;
  for (std::uint64_t bit = first_bit; bit < first_bit + count; ++bit) {
    value = value << 1 | (std::to_integer<unsigned>(stored[bit / 8]) >> (7 - bit % 8) & 1U);
  }
  return static_cast<std::uint16_t>(value);
}

template <class T>
void put(std::byte* samples, std::size_t index, T value) {
  std::memcpy(samples + index * sizeof value, &value, sizeof value);
}

}  // namespace

void unpack_values(const PageFormat& format, std::size_t values, std::size_t value,
                   const std::byte* stored, std::size_t count, std::byte* samples) {
  const std::size_t stored_bytes = format.bits / 8;
  const bool is_half = format.sample_format == SAMPLEFORMAT_IEEEFP && format.bits == 16;
  if (is_half) {
    for (std::size_t i = 0; i < count; ++i) {
      std::uint16_t half = 0;
      std::memcpy(&half, stored + (i * values + value) * 2, 2);
      put(samples, i, from_half(half));
    }
  } else if (format.bits % 8 == 0 && values == 1) {
    std::memcpy(samples, stored, count * stored_bytes);
  } else if (format.bits % 8 == 0) {
    for (std::size_t i = 0; i < count; ++i) {
      std::memcpy(samples + i * stored_bytes, stored + (i * values + value) * stored_bytes,
                  stored_bytes);
    }
  } else {
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint16_t bits =
          bits_at(stored, (std::uint64_t{i} * values + value) * format.bits, format.bits);
      format.bits < 8 ? put(samples, i, static_cast<std::uint8_t>(bits)) : put(samples, i, bits);
    }
  }
}

}  // namespace isoatlas::detail::io
