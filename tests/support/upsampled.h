// SPDX-License-Identifier: Apache-2.0
// Upsampling by the definition, one axis after the other, as a whole volume.
#pragma once

#include <algorithm>
#include <vector>

#include "field/interpolated_field.h"
#include "support/volumes.h"

namespace isoatlas::detail::test {

/// A Catmull-Rom spline or a line through samples that are `f` at whole numbers, up to the last
/// one.
template <class F>
double between_samples(F f, std::size_t last, std::size_t i, double t,
                       Interpolation interpolation) {
  if (t == 0) return f(i);
  const double a = f(i), b = f(std::min(i + 1, last));
  if (interpolation == Interpolation::trilinear) return a + t * (b - a);
  const double before = f(i == 0 ? 0 : i - 1), after = f(std::min(i + 2, last));
  return a + (-0.5 * t * (1 - t) * (1 - t) * (before - a) +
              t * (0.5 + t * (2 - 1.5 * t)) * (b - a) - 0.5 * t * t * (1 - t) * (after - a));
}

/// The samples of `volume` (finite ones) at `factor` points per step, of float64, with the same
/// spacing.
inline Volume upsampled(const Volume& volume, Interpolation interpolation, std::size_t factor) {
  const InterpolatedField field(volume, {0, Inside::above, NonFinite::refuse});
  Size size = volume.view.grid.size;
  std::vector<double> values;
  for (std::size_t z = 0; z < size[2]; ++z) {
    for (std::size_t y = 0; y < size[1]; ++y) {
      for (std::size_t x = 0; x < size[0]; ++x)
        values.push_back(
            field.at({static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)})
                .value);
    }
  }
  for (const std::size_t axis : {2, 1, 0}) {
    Size finer = size;
    finer[axis] = (size[axis] - 1) * factor + 1;
    std::vector<double> out;
    for (std::size_t z = 0; z < finer[2]; ++z) {
      for (std::size_t y = 0; y < finer[1]; ++y) {
        for (std::size_t x = 0; x < finer[0]; ++x) {
          Size at{x, y, z};
          const std::size_t fine = at[axis];
          const auto along = [&](std::size_t i) {
            at[axis] = i;
            return values[at[0] + size[0] * (at[1] + size[1] * at[2])];
          };
          const double t = static_cast<double>(fine % factor) / static_cast<double>(factor);
          out.push_back(between_samples(along, size[axis] - 1, fine / factor, t, interpolation));
        }
      }
    }
    size = finer;
    values = std::move(out);
  }
  Grid grid;
  grid.size = size;
  grid.spacing = volume.view.grid.spacing;
  return own<double>(grid, SampleType::float64, std::move(values));
}

}  // namespace isoatlas::detail::test
