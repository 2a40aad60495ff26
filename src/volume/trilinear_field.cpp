// SPDX-License-Identifier: Apache-2.0
#include "volume/trilinear_field.h"

#include <algorithm>
#include <type_traits>

#include "core/vector_math.h"
#include "volume/field.h"

namespace isoatlas {

template <class T>
struct TrilinearField::SamplesOf : Samples {
  SamplesOf(const VolumeView& volume, const InsideRule& rule) : field(volume, rule) {}
  std::array<double, 8> corners(const std::array<std::size_t, 8>& sample) const override {
    std::array<double, 8> f;
    for (std::size_t k = 0; k < 8; ++k) f[k] = field[sample[k]];
    return std::is_same_v<T, double> ? tamed(f) : f;
  }
  Field<T> field;
};

TrilinearField::TrilinearField(const VolumeView& volume, const InsideRule& rule)
    : size_(volume.grid.size),
      last_{static_cast<double>(size_[0] - 1), static_cast<double>(size_[1] - 1), static_cast<double>(size_[2] - 1)},
      samples_(visit_sample_type(
          volume.type, [&]<class T>(const T*) -> std::shared_ptr<const Samples> { return std::make_shared<SamplesOf<T>>(volume, rule); })) {
}

Vec3 TrilinearField::clamped(Vec3 p) const {
  return {std::clamp(p.x, 0.0, last_.x), std::clamp(p.y, 0.0, last_.y), std::clamp(p.z, 0.0, last_.z)};
}

TrilinearField::Value TrilinearField::at(Vec3 p) const {
  p = clamped(p);
  const std::array<std::size_t, 3> c{std::min(static_cast<std::size_t>(p.x), size_[0] - 2),
                                     std::min(static_cast<std::size_t>(p.y), size_[1] - 2),
                                     std::min(static_cast<std::size_t>(p.z), size_[2] - 2)};
  const std::size_t first = c[0] + size_[0] * (c[1] + size_[1] * c[2]), y = size_[0], z = size_[0] * size_[1];
  const TrilinearCell cell(
      samples_->corners({first, first + 1, first + y, first + y + 1, first + z, first + z + 1, first + z + y, first + z + y + 1}));
  const Vec3 local = p - Vec3{static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])};
  return {cell.value(local), cell.gradient(local)};
}

}  // namespace isoatlas
