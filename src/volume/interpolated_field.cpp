// SPDX-License-Identifier: Apache-2.0
#include "volume/interpolated_field.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "core/vector_math.h"
#include "volume/field.h"

namespace isoatlas {

template <class T>
struct InterpolatedField::SamplesOf : Samples {
  SamplesOf(const VolumeView& volume, const InsideRule& rule) : size(volume.grid.size), field(volume, rule) {}
  double value(std::size_t sample) const override { return field[sample]; }
  std::array<double, 8> corners(const std::array<std::size_t, 8>& sample) const override {
    std::array<double, 8> f;
    for (std::size_t k = 0; k < 8; ++k) f[k] = field[sample[k]];
    return std::is_same_v<T, double> ? tamed(f) : f;
  }
  std::array<double, 64> around(const std::array<std::size_t, 3>& cell) const override {
    const std::array<double, 64> f =
        values_around(field, size, {cubic_samples(cell[0], size[0]), cubic_samples(cell[1], size[1]), cubic_samples(cell[2], size[2])});
    return std::is_same_v<T, double> ? tamed(f) : f;
  }
  std::array<std::size_t, 3> size;
  Field<T> field;
};

InterpolatedField::InterpolatedField(const VolumeView& volume, const InsideRule& rule, Interpolation interpolation,
                                     std::uint32_t supersample)
    : size_(volume.grid.size),
      last_(supersample * Vec3{static_cast<double>(size_[0] - 1), static_cast<double>(size_[1] - 1), static_cast<double>(size_[2] - 1)}),
      interpolation_(interpolation),
      supersample_(supersample),
      samples_(visit_sample_type(
          volume.type, [&]<class T>(const T*) -> std::shared_ptr<const Samples> { return std::make_shared<SamplesOf<T>>(volume, rule); })) {
  if (supersample > 1) upsampled_.emplace(volume, rule, interpolation, supersample);
}

Vec3 InterpolatedField::clamped(Vec3 p) const {
  return {std::clamp(p.x, 0.0, last_.x), std::clamp(p.y, 0.0, last_.y), std::clamp(p.z, 0.0, last_.z)};
}

InterpolatedField::Value InterpolatedField::at(Vec3 p) const {
  p = clamped(p);
  const double steps = supersample_, per_step = 1 / steps;
  p = {p.x / steps, p.y / steps, p.z / steps};  // division finds the volume's samples exactly
  const std::array<std::size_t, 3> c{std::min(static_cast<std::size_t>(p.x), size_[0] - 2),
                                     std::min(static_cast<std::size_t>(p.y), size_[1] - 2),
                                     std::min(static_cast<std::size_t>(p.z), size_[2] - 2)};
  const Vec3 local = p - Vec3{static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])};
  if (interpolation_ == Interpolation::tricubic) {
    const auto [value, gradient] = TricubicCell(samples_->around(c)).at(local);
    return {value, per_step * gradient};
  }
  const std::size_t first = c[0] + size_[0] * (c[1] + size_[1] * c[2]), y = size_[0], z = size_[0] * size_[1];
  const TrilinearCell cell(
      samples_->corners({first, first + 1, first + y, first + y + 1, first + z, first + z + 1, first + z + y, first + z + y + 1}));
  return {cell.value(local), per_step * cell.gradient(local)};
}

double InterpolatedField::at_sample(Vec3 sample) const {
  const Vec3 p = clamped(sample);
  const std::array<std::size_t, 3>& size = upsampled_ ? upsampled_->size() : size_;
  const std::size_t i = static_cast<std::size_t>(p.x) + size[0] * (static_cast<std::size_t>(p.y) + size[1] * static_cast<std::size_t>(p.z));
  return upsampled_ ? (*upsampled_)[i] : samples_->value(i);
}

std::optional<double> InterpolatedField::zero_on_edge(const Vec3 low, int axis) const {
  const Vec3 step{axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0};
  const auto [f, g] = tamed(std::array{at_sample(low), at_sample(low + step)});
  if ((f >= 0) == (g >= 0)) return std::nullopt;
  const double linear = f / (f - g), start = std::isfinite(linear) ? linear : 0.5;
  if (interpolation_ == Interpolation::trilinear) return start;
  return zero_between(f >= 0, start, [&](double t) {
    const Value v = at(low + t * step);
    return std::pair(v.value, dot(v.gradient, step));
  });
}

}  // namespace isoatlas
