// SPDX-License-Identifier: Apache-2.0
#include "field/interpolated_field.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "core/vector_math.h"
#include "field/field.h"

namespace isoatlas::detail {

template <class T>
struct InterpolatedField::SamplesOf : Samples {
  SamplesOf(const VolumeView& volume, const InsideRule& rule)
      : size(volume.grid.size), field(volume, rule) {}
  double value(std::size_t sample) const override { return field[sample]; }
  std::array<double, 8> corners(std::size_t first) const override {
    const std::size_t y = size[0], z = size[0] * size[1];
    std::array<double, 8> f;
    for (std::size_t k = 0; k < 8; ++k)
      f[k] = field[first + (k & 1) + (k >> 1 & 1) * y + (k >> 2) * z];
    return std::is_same_v<T, double> ? rescaled(f) : f;
  }
  std::array<double, 64> around(const std::array<std::size_t, 3>& cell) const override {
    const std::array<double, 64> f =
        values_around(field, size,
                      {cubic_samples(cell[0], size[0]), cubic_samples(cell[1], size[1]),
                       cubic_samples(cell[2], size[2])});
    return std::is_same_v<T, double> ? rescaled(f) : f;
  }
  std::array<std::size_t, 3> size;
  Field<T> field;
};

InterpolatedField::InterpolatedField(const VolumeView& volume, const InsideRule& rule,
                                     Interpolation interpolation, std::uint32_t supersample)
    : size_(volume.grid.size),
      last_(supersample * Vec3{static_cast<double>(size_[0] - 1), static_cast<double>(size_[1] - 1),
                               static_cast<double>(size_[2] - 1)}),
      interpolation_(interpolation),
      supersample_(supersample),
      samples_(
          visit_sample_type(volume.type, [&]<class T>(const T*) -> std::shared_ptr<const Samples> {
            return std::make_shared<SamplesOf<T>>(volume, rule);
          })) {
  if (supersample > 1) upsampled_.emplace(volume, rule, interpolation, supersample);
}

Vec3 InterpolatedField::clamped(Vec3 p) const {
  return {std::clamp(p.x, 0.0, last_.x), std::clamp(p.y, 0.0, last_.y),
          std::clamp(p.z, 0.0, last_.z)};
}

InterpolatedField::Value InterpolatedField::at(Vec3 p) const {
  Cursor cursor;
  return at(p, cursor);
}

InterpolatedField::Value InterpolatedField::at(Vec3 p, Cursor& cursor) const {
  p = clamped(p);
  const double steps = supersample_, inverse_steps = 1 / steps;
  if (supersample_ > 1)
    p = {p.x / steps, p.y / steps, p.z / steps};  // division finds the volume's samples exactly
  const std::array<std::size_t, 3> c{std::min(static_cast<std::size_t>(p.x), size_[0] - 2),
                                     std::min(static_cast<std::size_t>(p.y), size_[1] - 2),
                                     std::min(static_cast<std::size_t>(p.z), size_[2] - 2)};
  const Vec3 local =
      p - Vec3{static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])};
  if (interpolation_ == Interpolation::tricubic) {
    const auto [value, gradient] = TricubicCell(samples_->around(c)).at(local);
    return {value, inverse_steps * gradient};
  }
  const std::size_t first = first_sample(c);
  if (first != cursor.first) cursor.cell = TrilinearCell(samples_->corners(first));
  cursor.first = first;
  return {cursor.cell.value(local), inverse_steps * cursor.cell.gradient(local)};
}

std::optional<TrilinearCell> InterpolatedField::cell(Vec3 low) const {
  if (interpolation_ != Interpolation::trilinear) return std::nullopt;
  if (supersample_ == 1)
    return cell_at({static_cast<std::size_t>(low.x), static_cast<std::size_t>(low.y),
                    static_cast<std::size_t>(low.z)});
  std::array<double, 8> corner;
  for (std::size_t k = 0; k < 8; ++k)
    corner[k] = at(low + Vec3{static_cast<double>(k & 1), static_cast<double>(k >> 1 & 1),
                              static_cast<double>(k >> 2)})
                    .value;
  return TrilinearCell(corner);
}

std::optional<InterpolatedField::Range> InterpolatedField::gradient_range(
    Vec3 low, Vec3 high, std::size_t max_cells) const {
  if (interpolation_ != Interpolation::trilinear) return std::nullopt;
  const std::array<double, 3> last{last_.x, last_.y, last_.z}, from{low.x, low.y, low.z},
      to{high.x, high.y, high.z};
  std::array<double, 3> a, b;  // the box clipped to the volume, in units of its own samples
  std::array<std::size_t, 3> first, end;
  std::array<bool, 3> exceeds;
  std::size_t cells = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    exceeds[k] = from[k] < 0 || to[k] > last[k];
    a[k] = std::clamp(from[k], 0.0, last[k]) / supersample_;
    b[k] = std::clamp(to[k], 0.0, last[k]) / supersample_;
    // A point on the wall between two cells belongs to both.
    first[k] = std::min(static_cast<std::size_t>(std::max(0.0, std::ceil(a[k]) - 1)), size_[k] - 2);
    end[k] = std::min(static_cast<std::size_t>(b[k]), size_[k] - 2) + 1;
    cells *= end[k] - first[k];
  }
  if (cells > max_cells) return std::nullopt;
  std::array<double, 3> lowest, highest;
  lowest.fill(INFINITY);
  highest.fill(-INFINITY);
  bool is_finite = true;
  for (std::size_t z = first[2]; z < end[2]; ++z) {
    for (std::size_t y = first[1]; y < end[1]; ++y) {
      for (std::size_t x = first[0]; x < end[0]; ++x) {
        const auto clamp_to_cell = [](double p, std::size_t corner) {
          return std::clamp(p - static_cast<double>(corner), 0.0, 1.0);
        };
        const Vec3 local_low{clamp_to_cell(a[0], x), clamp_to_cell(a[1], y),
                             clamp_to_cell(a[2], z)},
            local_high{clamp_to_cell(b[0], x), clamp_to_cell(b[1], y), clamp_to_cell(b[2], z)};
        cell_at({x, y, z}).for_each_slope(
            local_low, local_high, [&](std::size_t axis, double low_slope, double high_slope) {
              is_finite = is_finite && std::isfinite(low_slope) && std::isfinite(high_slope);
              lowest[axis] = std::min(lowest[axis], low_slope);
              highest[axis] = std::max(highest[axis], high_slope);
            });
      }
    }
  }
  if (!is_finite) return std::nullopt;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!exceeds[k]) continue;
    lowest[k] = std::min(lowest[k], 0.0);
    highest[k] = std::max(highest[k], 0.0);
  }
  const double inverse_steps = 1 / static_cast<double>(supersample_);
  return Range{inverse_steps * Vec3{lowest[0], lowest[1], lowest[2]},
               inverse_steps * Vec3{highest[0], highest[1], highest[2]}};
}

double InterpolatedField::at_sample(Vec3 sample) const {
  const Vec3 p = clamped(sample);
  const std::array<std::size_t, 3>& size = upsampled_ ? upsampled_->size() : size_;
  const std::size_t i =
      static_cast<std::size_t>(p.x) +
      size[0] * (static_cast<std::size_t>(p.y) + size[1] * static_cast<std::size_t>(p.z));
  return upsampled_ ? (*upsampled_)[i] : samples_->value(i);
}

std::optional<double> InterpolatedField::zero_on_edge(const Vec3 low, int axis) const {
  const Vec3 step{axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0};
  const auto [f, g] = rescaled(std::array{at_sample(low), at_sample(low + step)});
  if ((f >= 0) == (g >= 0)) return std::nullopt;
  const double linear = f / (f - g), start = std::isfinite(linear) ? linear : 0.5;
  if (interpolation_ == Interpolation::trilinear) return start;
  return zero_between(f >= 0, start, [&](double t) {
    const Value v = at(low + t * step);
    return std::pair(v.value, dot(v.gradient, step));
  });
}

}  // namespace isoatlas::detail
