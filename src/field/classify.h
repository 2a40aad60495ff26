// SPDX-License-Identifier: Apache-2.0
// Inside or outside: the rule that determines the topology, applied to samples in their native
// type.
#pragma once

#include <cstdint>
#include <vector>

#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

struct InsideRule {
  double isovalue = 0;
  Inside inside = Inside::above;
  NonFinite non_finite = NonFinite::refuse;
};

/// One bit per sample, 1 = inside, rows padded by one clamped sample on both sides: bit i + 1 of
/// row (y, z) is sample (i, y, z), bit 0 repeats sample 0 and bit nx + 1 repeats sample nx - 1 (the
/// zero-thickness layer of the surface complex).
struct SignBits {
  std::size_t rows_y = 0;           ///< rows per slice
  std::size_t words = 0;            ///< 64-bit words per row
  std::vector<std::uint64_t> bits;  ///< row (y, z) starts at (y + rows_y * z) * words
  bool any_inside = false, any_outside = false;

  const std::uint64_t* row(std::size_t y, std::size_t z) const {
    return bits.data() + (y + rows_y * z) * words;
  }
};

/// @throws Error(unsupported) if a sample is not finite and the rule refuses that: count and first
/// index
/// @cost   one pass over the samples, N/8 bytes
SignBits classify(const VolumeView& volume, const InsideRule& rule, const RunControl& control);

}  // namespace isoatlas::detail
