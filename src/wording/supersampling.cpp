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

// Measured bytes per crossed grid cell: 140 (a ball) to 260 (noise) for coarse meshes, 390 to 840
// for refined ones.
constexpr double kBytesPerCoarseCell = 250, kBytesPerRefinedCell = 700;

/// The number of grid cells with samples inside and outside.
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
      // Values of the previous word. Its last sample and the first one of this word share a grid
      // cell.
      std::uint64_t any_before = 0, all_before = 0;
      for (std::size_t w = 0; w < signs.words; ++w) {
        const std::uint64_t any = rows[0][w] | rows[1][w] | rows[2][w] | rows[3][w];
        const std::uint64_t all = rows[0][w] & rows[1][w] & rows[2][w] & rows[3][w];
        // Bit i + 1 is sample i. Bit i + 1 of `crossed` is the grid cell between samples i - 1 and
        // i; it exists for i in 1 .. nx - 1.
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

/// The terms of the memory estimate.
struct MemoryEstimate {
  const Grid& grid;
  double sample_bytes = 0;
  double crossed_cells = 0, bytes_per_cell = 0;

  double bytes(std::uint32_t factor) const {
    double upsampled = 1;
    for (const std::size_t n : grid.size) upsampled *= static_cast<double>(n - 1) * factor + 1;
    return sample_bytes + upsampled / 8 + crossed_cells * factor * factor * bytes_per_cell;
  }
};

MemoryEstimate estimate_of(const VolumeView& volume, const ExtractOptions& options,
                           const RunControl& control) {
  const Grid& grid = volume.grid;
  return {grid, static_cast<double>(grid.sample_count() * bytes_per_sample(volume.type)),
          static_cast<double>(count_crossed_cells(volume, options, control)),
          options.refine.empty() ? kBytesPerCoarseCell : kBytesPerRefinedCell};
}

std::string gigabytes(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, bytes < 10 * 0x1p30 ? "%.1f GiB" : "%.0f GiB", bytes / 0x1p30);
  return text;
}

/// The largest factor below `factor` for which `is_possible` is true, or 1. If it is true for a
/// factor, it must be true for all smaller ones; for `factor` itself it is false.
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
  return static_cast<std::uint64_t>(
      estimate_of(volume, options, control).bytes(options.supersample));
}

std::uint64_t require_memory_for_supersampling(const VolumeView& volume,
                                               const ExtractOptions& options, std::uint64_t limit,
                                               const RunControl& control) {
  if (options.supersample <= 1) return 0;
  const double available = static_cast<double>(limit == 0 ? io::default_memory_limit() : limit);
  const MemoryEstimate estimate = estimate_of(volume, options, control);
  const auto is_possible = [&](std::uint32_t factor) {
    return can_be_upsampled(volume.grid, factor) && estimate.bytes(factor) <= available;
  };
  if (is_possible(options.supersample))
    return static_cast<std::uint64_t>(estimate.bytes(options.supersample));
  const std::uint32_t largest = largest_factor(options.supersample, is_possible);
  const std::string factor = std::to_string(options.supersample);
  const std::string reason =
      can_be_upsampled(volume.grid, options.supersample)
          ? "supersampling " + factor + " times needs about " +
                gigabytes(estimate.bytes(options.supersample)) + " of memory, but only " +
                gigabytes(available) + " can be used"
          : "supersampling " + factor + " times makes more samples than the limit of 2^36";
  throw Error(
      ErrorCode::bad_argument,
      reason + ": expected " +
          (largest == 1 ? "no supersampling (1)" : std::to_string(largest) + " times at most"));
}

}  // namespace isoatlas::detail
