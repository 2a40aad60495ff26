// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <memory>
#include <new>
#include <string>

#include "core/parallel.h"
#include "core/require.h"
#include "isoatlas/error.h"
#include "isoatlas/field.h"

namespace isoatlas {
using namespace detail;
namespace {

constexpr double kMostPerAxis = 1e6;
constexpr std::size_t kRowsPerChunk = 16;

}  // namespace

Volume sample(const ScalarField& field, const Grid& grid, const RunControl& control) try {
  require(static_cast<bool>(field.value), "the field has no function");
  const std::size_t nx = grid.size[0], ny = grid.size[1], nz = grid.size[2];
  require(nx >= 2 && ny >= 2 && nz >= 2,
          "a field is sampled at two points or more along each axis");
  require(static_cast<double>(nx) * static_cast<double>(ny) * static_cast<double>(nz) < 0x1p50,
          "the grid has too many samples");
  const ThreadLimit threads(control.threads);
  const std::shared_ptr<double[]> samples(new double[grid.sample_count()]);
  for_each_index(ny * nz, kRowsPerChunk, &control, [&](std::size_t row) {
    double* to = samples.get() + row * nx;
    const auto y = static_cast<double>(row % ny), z = static_cast<double>(row / ny);
    for (std::size_t x = 0; x < nx; ++x)
      *to++ = field.value(grid.to_world({static_cast<double>(x), y, z}));
  });
  return {{grid, SampleType::float64, samples.get()}, samples};
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory for the samples of this field");
}

Volume sample(const ScalarField& field, Vec3 low, Vec3 high, double spacing,
              const RunControl& control) {
  require(std::isfinite(spacing) && spacing > 0, "a field needs a positive spacing");
  Grid grid;
  grid.origin = low;
  const std::array<double, 3> side{high.x - low.x, high.y - low.y, high.z - low.z};
  std::array<double, 3> step{};
  for (std::size_t a = 0; a < 3; ++a) {
    require(std::isfinite(side[a]) && side[a] > 0,
            std::string("the box has no length along ") + "xyz"[a]);
    const double steps = std::max(1.0, std::round(side[a] / spacing));
    require(steps < kMostPerAxis,
            std::string("the spacing gives more than a million samples along ") + "xyz"[a]);
    grid.size[a] = static_cast<std::size_t>(steps) + 1;
    step[a] = side[a] / steps;
  }
  grid.spacing = {step[0], step[1], step[2]};
  return sample(field, grid, control);
}

}  // namespace isoatlas
