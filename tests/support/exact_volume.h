// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "support/volumes.h"

namespace isoatlas::detail::test {

/// The function at the samples' indices, unrounded.
inline Volume exact_volume_on(const Grid& grid, const Function& f) {
  std::vector<double> values;
  values.reserve(grid.sample_count());
  for (std::size_t z = 0; z < grid.size[2]; ++z) {
    for (std::size_t y = 0; y < grid.size[1]; ++y) {
      for (std::size_t x = 0; x < grid.size[0]; ++x)
        values.push_back(f(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)));
    }
  }
  return own<double>(grid, SampleType::float64, std::move(values));
}

inline Volume exact_volume(Size size, const Function& f, Vec3 spacing = {1, 1, 1}) {
  Grid grid;
  grid.size = size;
  grid.spacing = spacing;
  return exact_volume_on(grid, f);
}

}  // namespace isoatlas::detail::test
