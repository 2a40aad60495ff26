// SPDX-License-Identifier: Apache-2.0
// The scalar field around the isovalue, sample by sample and inside one cell.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "volume/classify.h"
#include "volume/sample_type.h"

namespace isoatlas {

/// Samples of one type as numbers that are >= 0 inside and < 0 outside (up to rounding; the sign bits decide, not these).
template <class T>
class Field {
 public:
  Field(const VolumeView& volume, const InsideRule& rule)
      : samples_(static_cast<const T*>(volume.samples)), isovalue_(rule.isovalue), sign_(rule.inside == Inside::above ? 1 : -1) {
    if constexpr (std::is_floating_point_v<T>) {
      if (rule.non_finite != NonFinite::refuse) {
        // A stand-in as far from the isovalue as the farthest finite sample, so that interpolation stays sensible.
        const SampleSummary s = summarize(volume);
        far_ = std::max({std::abs(s.maximum - isovalue_), std::abs(s.minimum - isovalue_), 1e-300});
        nan_side_ = rule.non_finite == NonFinite::above ? 1 : -1;
      }
    }
  }

  double operator[](std::size_t i) const { return sign_ * (finite(samples_[i]) - isovalue_); }

  /// The sample itself, for exact decisions.
  long double exact(std::size_t i) const {
    if constexpr (std::is_floating_point_v<T>) {
      return finite(samples_[i]);
    } else {
      return static_cast<long double>(samples_[i]);
    }
  }
  double isovalue() const { return isovalue_; }

 private:
  double finite(T v) const {
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(v)) return isovalue_ + far_ * (std::isnan(v) ? nan_side_ : v > 0 ? 1 : -1);
    }
    return static_cast<double>(v);
  }

  const T* samples_;
  double isovalue_;
  double sign_;
  double far_ = 0;
  double nan_side_ = 0;
};

/// Corner values brought into a range where products of them neither over- nor underflow. Only the sign and the ratios matter.
inline std::array<double, 8> tamed(std::array<double, 8> f) {
  constexpr double kHuge = 1e60, kTiny = 1e-60;
  double largest = 0;
  for (double& x : f) {
    x = std::clamp(x, -std::numeric_limits<double>::max(), std::numeric_limits<double>::max());
    largest = std::max(largest, std::abs(x));
  }
  if (largest > kHuge || (largest < kTiny && largest > 0)) {
    const int shift = -std::ilogb(largest);
    for (double& x : f) x = std::ldexp(x, shift);
  }
  return f;
}

/// The trilinear interpolant of one cell in local coordinates [0,1]^3, from its 8 corner values (corner = x + 2y + 4z).
class TrilinearCell {
 public:
  explicit TrilinearCell(const std::array<double, 8>& f)
      : c0_(f[0]),
        cx_(f[1] - f[0]),
        cy_(f[2] - f[0]),
        cz_(f[4] - f[0]),
        cxy_(f[3] - f[1] - f[2] + f[0]),
        cxz_(f[5] - f[1] - f[4] + f[0]),
        cyz_(f[6] - f[2] - f[4] + f[0]),
        cxyz_(f[7] - f[3] - f[5] - f[6] + f[1] + f[2] + f[4] - f[0]) {}

  double value(Vec3 p) const { return c0_ + p.x * (cx_ + p.y * (cxy_ + p.z * cxyz_) + p.z * cxz_) + p.y * (cy_ + p.z * cyz_) + p.z * cz_; }
  Vec3 gradient(Vec3 p) const {
    return {cx_ + p.y * (cxy_ + p.z * cxyz_) + p.z * cxz_, cy_ + p.x * (cxy_ + p.z * cxyz_) + p.z * cyz_,
            cz_ + p.x * (cxz_ + p.y * cxyz_) + p.y * cyz_};
  }

 private:
  double c0_, cx_, cy_, cz_, cxy_, cxz_, cyz_, cxyz_;
};

}  // namespace isoatlas
