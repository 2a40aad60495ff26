// SPDX-License-Identifier: Apache-2.0
#include "volume/interpolated_field.h"

#include <algorithm>
#include <type_traits>

#include "core/vector_math.h"
#include "volume/field.h"

namespace isoatlas {

template <class T>
struct InterpolatedField::SamplesOf : Samples {
  SamplesOf(const VolumeView& volume, const InsideRule& rule) : size(volume.grid.size), field(volume, rule) {}
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

InterpolatedField::InterpolatedField(const VolumeView& volume, const InsideRule& rule, Interpolation interpolation)
    : size_(volume.grid.size),
      last_{static_cast<double>(size_[0] - 1), static_cast<double>(size_[1] - 1), static_cast<double>(size_[2] - 1)},
      interpolation_(interpolation),
      samples_(visit_sample_type(
          volume.type, [&]<class T>(const T*) -> std::shared_ptr<const Samples> { return std::make_shared<SamplesOf<T>>(volume, rule); })) {
}

Vec3 InterpolatedField::clamped(Vec3 p) const {
  return {std::clamp(p.x, 0.0, last_.x), std::clamp(p.y, 0.0, last_.y), std::clamp(p.z, 0.0, last_.z)};
}

InterpolatedField::Value InterpolatedField::at(Vec3 p) const {
  p = clamped(p);
  const std::array<std::size_t, 3> c{std::min(static_cast<std::size_t>(p.x), size_[0] - 2),
                                     std::min(static_cast<std::size_t>(p.y), size_[1] - 2),
                                     std::min(static_cast<std::size_t>(p.z), size_[2] - 2)};
  const Vec3 local = p - Vec3{static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])};
  if (interpolation_ == Interpolation::tricubic) {
    const auto [value, gradient] = TricubicCell(samples_->around(c)).at(local);
    return {value, gradient};
  }
  const std::size_t first = c[0] + size_[0] * (c[1] + size_[1] * c[2]), y = size_[0], z = size_[0] * size_[1];
  const TrilinearCell cell(
      samples_->corners({first, first + 1, first + y, first + y + 1, first + z, first + z + 1, first + z + y, first + z + y + 1}));
  return {cell.value(local), cell.gradient(local)};
}

}  // namespace isoatlas
