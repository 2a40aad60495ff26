// SPDX-License-Identifier: Apache-2.0
#include "field/classify.h"

#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>

#include "core/parallel.h"
#include "field/sample_type.h"

namespace isoatlas::detail {
namespace {

// "value >= isovalue" as a comparison in the sample's own type: value >= threshold, unless no value
// or every value is.
template <class T>
struct Threshold {
  T value{};
  bool none = false;  // no value of the type satisfies the condition
};

// The smallest T that is >= isovalue (upwards), or the largest that is <= isovalue. Exact for every
// type.
template <class T>
Threshold<T> threshold_for(double isovalue, bool upwards) {
  using Limits = std::numeric_limits<T>;
  if constexpr (std::is_floating_point_v<T>) {
    if (std::abs(isovalue) >
        static_cast<double>(Limits::max())) {  // between the largest finite value and infinity
      if (upwards) return {isovalue > 0 ? Limits::infinity() : Limits::lowest(), false};
      return {isovalue > 0 ? Limits::max() : -Limits::infinity(), false};
    }
    T v = static_cast<T>(isovalue);
    if (upwards && static_cast<double>(v) < isovalue) v = std::nextafter(v, Limits::infinity());
    if (!upwards && static_cast<double>(v) > isovalue) v = std::nextafter(v, -Limits::infinity());
    return {v, false};
  } else {
    const double r = upwards ? std::ceil(isovalue) : std::floor(isovalue);
    // 2^digits is exact as a double; max() itself may not be.
    const double beyond = std::ldexp(1.0, Limits::digits);
    const double lowest = static_cast<double>(Limits::min());
    if (r >= beyond) return {Limits::max(), upwards};
    if (r < lowest) return {Limits::min(), !upwards};
    return {static_cast<T>(r), false};
  }
}

template <class T>
bool any_non_finite(const T* row, std::size_t n) {
  // Tests bit patterns, so that the compiler can vectorize it.
  using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
  constexpr Bits kExponent =
      sizeof(T) == 4 ? Bits{0x7F800000u} : static_cast<Bits>(0x7FF0000000000000u);
  Bits found = 0;
  for (std::size_t i = 0; i < n; ++i) {
    found |= static_cast<Bits>((std::bit_cast<Bits>(row[i]) & kExponent) == kExponent);
  }
  return found != 0;
}

// Packs 0/1 bytes, 8 at a time: the multiplication gathers the low bit of each byte into the top
// byte.
std::uint64_t pack64(const std::uint8_t* flags) {
  std::uint64_t word = 0;
  for (int k = 0; k < 8; ++k) {
    std::uint64_t eight;
    std::memcpy(&eight, flags + 8 * k, 8);
    if constexpr (std::endian::native == std::endian::little) {
      eight = (eight * 0x0102040810204080u) >> 56;
    } else {
      eight = (eight * 0x8040201008040201u) >> 56;
    }
    word |= eight << (8 * k);
  }
  return word;
}

template <class T, class IsInside>
void classify_rows(const VolumeView& volume, const T* samples, IsInside is_inside, SignBits& out,
                   const RunControl& control, std::atomic<bool>& non_finite) {
  const auto [nx, ny, nz] = volume.grid.size;
  std::atomic<std::uint64_t> seen{0};  // bit 0: some inside, bit 1: some outside
  for_each_chunk(nz, 1, [&, nx = nx, ny = ny](std::size_t z0, std::size_t z1) {
    std::vector<std::uint8_t> flags(out.words * 64, 0);
    std::uint64_t chunk_seen = 0;
    for (std::size_t z = z0; z < z1; ++z) {
      control.check_cancelled();
      for (std::size_t y = 0; y < ny; ++y) {
        const T* row = samples + nx * (y + ny * z);
        if constexpr (std::is_floating_point_v<T>) {
          if (any_non_finite(row, nx)) non_finite.store(true, std::memory_order_relaxed);
        }
        for (std::size_t i = 0; i < nx; ++i)
          flags[i + 1] = static_cast<std::uint8_t>(is_inside(row[i]));
        flags[0] = flags[1];
        flags[nx + 1] = flags[nx];
        std::uint64_t* bits = out.bits.data() + (y + ny * z) * out.words;
        std::uint64_t any = 0, all = ~std::uint64_t{0};
        for (std::size_t w = 0; w < out.words; ++w) {
          bits[w] = pack64(flags.data() + 64 * w);
          const std::size_t last = nx + 2 - 64 * w;  // bits in use from here on
          any |= bits[w];
          all &= last >= 64 ? bits[w] : bits[w] | (~std::uint64_t{0} << last);
        }
        if (any != 0) chunk_seen |= 1;
        if (all != ~std::uint64_t{0}) chunk_seen |= 2;
      }
    }
    seen.fetch_or(chunk_seen, std::memory_order_relaxed);
  });
  out.any_inside = (seen & 1) != 0;
  out.any_outside = (seen & 2) != 0;
}

}  // namespace

SignBits classify(const VolumeView& volume, const InsideRule& rule, const RunControl& control) {
  const auto [nx, ny, nz] = volume.grid.size;
  SignBits out;
  out.rows_y = ny;
  out.words = (nx + 2 + 63) / 64;
  out.bits.resize(out.words * ny * nz);
  std::atomic<bool> non_finite{false};

  visit_sample_type(volume.type, [&]<class T>(const T*) {
    const T* samples = static_cast<const T*>(volume.samples);
    const bool above = rule.inside == Inside::above;
    const bool nan_inside = rule.non_finite == (above ? NonFinite::above : NonFinite::below);
    const Threshold<T> threshold = threshold_for<T>(rule.isovalue, above);
    const T t = threshold.value;
    const auto run = [&](auto is_inside) {
      classify_rows(volume, samples, is_inside, out, control, non_finite);
    };
    if (threshold.none) {
      run([](T) { return false; });  // the isovalue is outside the type's range; NaN does not
                                     // matter, since the surface is empty
    } else if (above) {
      if (nan_inside) {
        run([t](T v) { return !(v < t); });
      } else {
        run([t](T v) { return v >= t; });
      }
    } else if (nan_inside) {
      run([t](T v) { return !(v > t); });
    } else {
      run([t](T v) { return v <= t; });
    }
  });
  control.check_cancelled();

  if (non_finite && rule.non_finite == NonFinite::refuse) {
    const SampleSummary s = summarize(volume);
    const auto [x, y, z] = s.first_non_finite;
    throw Error(ErrorCode::unsupported,
                std::to_string(s.nan_count) + " NaN and " + std::to_string(s.infinity_count) +
                    " infinite samples, the first at index (" + std::to_string(x) + ", " +
                    std::to_string(y) + ", " + std::to_string(z) + ")",
                Remedy::place_nan);
  }
  return out;
}

}  // namespace isoatlas::detail
