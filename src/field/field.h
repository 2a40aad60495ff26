// SPDX-License-Identifier: Apache-2.0
// The scalar field relative to the isovalue, at samples and inside one grid cell. "Cell" means grid
// cell in this file.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "core/exact_numbers.h"
#include "field/classify.h"
#include "field/sample_type.h"

namespace isoatlas::detail {

/// Samples of one type as numbers that are >= 0 inside and < 0 outside, up to rounding; sign bits
/// decide the topology, not these numbers.
template <class T>
class Field {
 public:
  Field(const VolumeView& volume, const InsideRule& rule)
      : samples_(static_cast<const T*>(volume.samples)),
        isovalue_(rule.isovalue),
        sign_(rule.inside == Inside::above ? 1 : -1) {
    if constexpr (std::is_floating_point_v<T>) {
      if (rule.non_finite != NonFinite::refuse) {
        // A substitute as far from the isovalue as the farthest finite sample, so that
        // interpolation stays meaningful.
        const SampleSummary s = summarize(volume);
        non_finite_offset_ =
            std::max({std::abs(s.maximum - isovalue_), std::abs(s.minimum - isovalue_), 1e-300});
        nan_side_ = rule.non_finite == NonFinite::above ? 1 : -1;
      }
    }
  }

  double operator[](std::size_t i) const { return sign_ * (sample(i) - isovalue_); }
  double sample(std::size_t i) const { return replace_non_finite(samples_[i]); }

  /// The sample itself, for exact decisions.
  ExactSample exact(std::size_t i) const {
    if constexpr (std::is_floating_point_v<T>) {
      return replace_non_finite(samples_[i]);
    } else {
      return samples_[i];
    }
  }
  double isovalue() const { return isovalue_; }

 private:
  double replace_non_finite(T v) const {
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(v))
        return isovalue_ + non_finite_offset_ * (std::isnan(v) ? nan_side_ : v > 0 ? 1 : -1);
    }
    return static_cast<double>(v);
  }

  const T* samples_;
  double isovalue_;
  double sign_;
  double non_finite_offset_ = 0;
  double nan_side_ = 0;
};

/// Scales the values of a grid cell so that products of them neither overflow nor underflow. Their
/// signs and ratios do not change.
template <std::size_t N>
std::array<double, N> rescaled(std::array<double, N> f) {
  constexpr double kHuge = 1e60, kTiny = 1e-60;
  double largest = 0;
  for (double& x : f) {
    x = std::clamp(x, -std::numeric_limits<double>::max(), std::numeric_limits<double>::max());
    largest = std::max(largest, std::abs(x));
  }
  if (largest > kHuge || (largest < kTiny && largest > 0)) {
    const int exponent = -std::ilogb(largest);
    for (double& x : f) x = std::ldexp(x, exponent);
  }
  return f;
}

/// The trilinear interpolant of one grid cell in local coordinates [0,1]^3, from its 8 corner
/// values (corner = x + 2y + 4z).
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

  double value(Vec3 p) const {
    return c0_ + p.x * (cx_ + p.y * (cxy_ + p.z * cxyz_) + p.z * cxz_) + p.y * (cy_ + p.z * cyz_) +
           p.z * cz_;
  }
  /// Calls add(axis, lowest, highest) for each component of the gradient, with its range over the
  /// box from `low` to `high`. Each component is linear in each of the two coordinates that it
  /// depends on, so its extremes are at corners.
  template <class Add>
  void for_each_slope(Vec3 low, Vec3 high, Add add) const {
    const auto range = [&](std::size_t axis, double c, double cu, double cv, double u0, double u1,
                           double v0, double v1) {
      const auto at = [&](double u, double v) { return c + u * (cu + v * cxyz_) + v * cv; };
      const double a = at(u0, v0), b = at(u0, v1), d = at(u1, v0), e = at(u1, v1);
      add(axis, std::min(std::min(a, b), std::min(d, e)), std::max(std::max(a, b), std::max(d, e)));
    };
    range(0, cx_, cxy_, cxz_, low.y, high.y, low.z, high.z);
    range(1, cy_, cxy_, cyz_, low.x, high.x, low.z, high.z);
    range(2, cz_, cxz_, cyz_, low.x, high.x, low.y, high.y);
  }

  Vec3 gradient(Vec3 p) const {
    return {cx_ + p.y * (cxy_ + p.z * cxyz_) + p.z * cxz_,
            cy_ + p.x * (cxy_ + p.z * cxyz_) + p.z * cyz_,
            cz_ + p.x * (cxz_ + p.y * cxyz_) + p.y * cyz_};
  }

 private:
  double c0_, cx_, cy_, cz_, cxy_, cxz_, cyz_, cxyz_;
};

/// A Catmull-Rom spline between the second and the third of four values: the weight of each value
/// at t in [0,1]. Interpolates the samples exactly, since the other weights are 0 at t = 0 and 1;
/// reproduces polynomials of degree two, up to rounding.
/// @source Catmull, Rom, A class of local interpolating splines, 1974; with tension 1/2
struct CubicWeights {
  explicit CubicWeights(double t)
      : value{-0.5 * t * (1 - t) * (1 - t), 1 + t * t * (1.5 * t - 2.5),
              t * (0.5 + t * (2 - 1.5 * t)), -0.5 * t * t * (1 - t)},
        slope{-0.5 + t * (2 - 1.5 * t), t * (4.5 * t - 5), 0.5 + t * (4 - 4.5 * t),
              t * (1.5 * t - 1)} {}
  std::array<double, 4> value, slope;
};

inline double weighted(const std::array<double, 4>& weight, const double* f) {
  return weight[0] * f[0] + weight[1] * f[1] + weight[2] * f[2] + weight[3] * f[3];
}

/// The samples along one axis that a tricubic cell depends on, from one before `low` to two after;
/// outside the volume, the sample on its boundary.
constexpr std::array<std::size_t, 4> cubic_samples(std::size_t low, std::size_t n) {
  return {low == 0 ? 0 : low - 1, low, low + 1 < n ? low + 1 : n - 1,
          low + 2 < n ? low + 2 : n - 1};
}

/// The 4 x 4 x 4 values at these samples, x + 4y + 16z.
template <class T>
std::array<double, 64> values_around(const Field<T>& field, const std::array<std::size_t, 3>& size,
                                     const std::array<std::array<std::size_t, 4>, 3>& sample) {
  std::array<double, 64> f;
  std::size_t n = 0;
  for (const std::size_t z : sample[2]) {
    for (const std::size_t y : sample[1]) {
      const std::size_t row = size[0] * (y + size[1] * z);
      for (const std::size_t x : sample[0]) f[n++] = field[row + x];
    }
  }
  return f;
}

/// The tricubic interpolant of one grid cell in local coordinates [0,1]^3, from the 4 x 4 x 4
/// values around it (x + 4y + 16z; the corners of the cell are those at 1 and 2).
class TricubicCell {
 public:
  explicit TricubicCell(const std::array<double, 64>& f) : f_(f) {}

  struct Value {
    double value;
    Vec3 gradient;
  };
  Value at(Vec3 p) const {
    const CubicWeights x(p.x), y(p.y), z(p.z);
    std::array<double, 4> value, dx, dy;  // per slice
    for (std::size_t k = 0; k < 4; ++k) {
      std::array<double, 4> row, slope;
      for (std::size_t j = 0; j < 4; ++j) {
        row[j] = weighted(x.value, &f_[4 * j + 16 * k]);
        slope[j] = weighted(x.slope, &f_[4 * j + 16 * k]);
      }
      value[k] = weighted(y.value, row.data());
      dx[k] = weighted(y.value, slope.data());
      dy[k] = weighted(y.slope, row.data());
    }
    return {weighted(z.value, value.data()),
            {weighted(z.value, dx.data()), weighted(z.value, dy.data()),
             weighted(z.slope, value.data())}};
  }
  double value(Vec3 p) const { return at(p).value; }
  Vec3 gradient(Vec3 p) const { return at(p).gradient; }

  /// The index of the value at a corner (x + 2y + 4z).
  static constexpr std::size_t corner(std::size_t c) {
    return 21 + (c & 1) + 4 * (c >> 1 & 1) + 16 * (c >> 2);
  }
  /// The four values of the spline along the cell's edge that starts at `corner` (x + 2y + 4z).
  std::array<double, 4> along(std::size_t corner, int axis) const {
    const std::size_t step = std::size_t{1} << (2 * axis);
    const std::size_t first = TricubicCell::corner(corner) - step;
    return {f_[first], f_[first + step], f_[first + 2 * step], f_[first + 3 * step]};
  }

 private:
  std::array<double, 64> f_;
};

/// The zero of f between 0 and 1, where f has different signs: by Newton's method, or by bisection
/// where that would leave the interval.
/// @param f  f(t) returns value and slope, the value > 0 inside
template <class F>
double zero_between(bool inside_at_0, double start, F f) {
  constexpr int kMaxSteps = 60;
  constexpr double kClose = 1e-12;
  double low = 0, high = 1, t = start;
  for (int step = 0; step < kMaxSteps; ++step) {
    const auto [value, slope] = f(t);
    if (value == 0) break;
    ((value > 0) == inside_at_0 ? low : high) = t;
    double next = t - value / slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);  // also for a NaN
    const bool close = std::abs(next - t) <= kClose;
    t = next;
    if (close) break;
  }
  return t;
}

}  // namespace isoatlas::detail
