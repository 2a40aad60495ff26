// SPDX-License-Identifier: Apache-2.0
#include "wording/supersampling.h"

#include <bit>
#include <cstdio>
#include <string>

#include "field/classify.h"
#include "field/upsampled_field.h"
#include "files/memory_limit.h"
#include "isoatlas/error.h"

namespace isoatlas::detail {
namespace {

// Measured: coarse meshes 140 (a ball) to 260 (noise), refined ones 390 to 840.
constexpr double kBytesPerCrossedCell = 250, kBytesPerRefinedCell = 700;

/// Grid cells with samples on both sides.
std::size_t count_crossed_cells(const VolumeView& volume, const ExtractOptions& options,
                                const RunControl& control) {
  const SignBits signs = classify(
      volume, {options.surface.isovalue, options.surface.inside, options.surface.non_finite},
      control);
  const auto [nx, ny, nz] = volume.grid.size;
  std::size_t count = 0;
  for (std::size_t z = 0; z + 1 < nz; ++z) {
    control.check_cancelled();
    for (std::size_t y = 0; y + 1 < ny; ++y) {
      const std::uint64_t* rows[4] = {signs.row(y, z), signs.row(y + 1, z), signs.row(y, z + 1),
                                      signs.row(y + 1, z + 1)};
      std::uint64_t any_before = 0, all_before = 0;  // of the word before, whose last sample is in
                                                     // a cell with this one's first
      for (std::size_t w = 0; w < signs.words; ++w) {
        const std::uint64_t any = rows[0][w] | rows[1][w] | rows[2][w] | rows[3][w];
        const std::uint64_t all = rows[0][w] & rows[1][w] & rows[2][w] & rows[3][w];
        // Bit i + 1 is sample i. Bit i + 1 of `crossed` is the cell between samples i - 1 and i,
        // which is one for i in 1 .. nx - 1.
        const std::uint64_t crossed =
            (any | any << 1 | any_before >> 63) & ~(all & (all << 1 | all_before >> 63));
        std::uint64_t cells = ~std::uint64_t{0};
        if (w == 0) cells &= ~std::uint64_t{3};
        if (nx + 1 < 64 * (w + 1))
          cells &= (nx + 1 <= 64 * w) ? 0 : (std::uint64_t{1} << (nx + 1 - 64 * w)) - 1;
        count += static_cast<std::size_t>(std::popcount(crossed & cells));
        any_before = any;
        all_before = all;
      }
    }
  }
  return count;
}

/// What the estimate is made of.
struct Demand {
  const Grid& grid;
  double sample_bytes = 0;
  double cells = 0, bytes_per_cell = 0;

  double bytes(std::uint32_t factor) const {
    double upsampled = 1;
    for (const std::size_t n : grid.size) upsampled *= static_cast<double>(n - 1) * factor + 1;
    return sample_bytes + upsampled / 8 + cells * factor * factor * bytes_per_cell;
  }
};

Demand demand_of(const VolumeView& volume, const ExtractOptions& options,
                 const RunControl& control) {
  const Grid& grid = volume.grid;
  return {grid, static_cast<double>(grid.sample_count() * bytes_per_sample(volume.type)),
          static_cast<double>(count_crossed_cells(volume, options, control)),
          options.refine.empty() ? kBytesPerCrossedCell : kBytesPerRefinedCell};
}

std::string gigabytes(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, bytes < 10 * 0x1p30 ? "%.1f GiB" : "%.0f GiB", bytes / 0x1p30);
  return text;
}

/// The largest factor up to `factor` that `is_possible`, which holds for all below one that it
/// holds for; 1 if for none.
template <class Predicate>
std::uint32_t largest_factor(std::uint32_t factor, Predicate is_possible) {
  std::uint32_t possible = 1, impossible = factor;
  while (impossible - possible > 1) {
    const std::uint32_t middle = possible + (impossible - possible) / 2;
    (is_possible(middle) ? possible : impossible) = middle;
  }
  return possible;
}

}  // namespace

std::uint64_t estimated_memory(const VolumeView& volume, const ExtractOptions& options,
                               const RunControl& control) {
  return static_cast<std::uint64_t>(demand_of(volume, options, control).bytes(options.supersample));
}

std::uint64_t require_memory_for_supersampling(const VolumeView& volume,
                                               const ExtractOptions& options, std::uint64_t limit,
                                               const RunControl& control) {
  if (options.supersample <= 1) return 0;
  const double available = static_cast<double>(limit == 0 ? io::default_memory_limit() : limit);
  const Demand demand = demand_of(volume, options, control);
  const auto is_possible = [&](std::uint32_t factor) {
    return can_be_upsampled(volume.grid, factor) && demand.bytes(factor) <= available;
  };
  if (is_possible(options.supersample))
    return static_cast<std::uint64_t>(demand.bytes(options.supersample));
  const std::uint32_t largest = largest_factor(options.supersample, is_possible);
  const std::string factor = std::to_string(options.supersample);
  const std::string reason =
      can_be_upsampled(volume.grid, options.supersample)
          ? "supersampling " + factor + " times takes about " +
                gigabytes(demand.bytes(options.supersample)) + " of memory, of which " +
                gigabytes(available) + " can be used"
          : "supersampling " + factor + " times makes more samples than are possible, 2^36";
  throw Error(
      ErrorCode::bad_argument,
      reason + ": expected " +
          (largest == 1 ? "no supersampling (1)" : std::to_string(largest) + " times at most"));
}

}  // namespace isoatlas::detail
