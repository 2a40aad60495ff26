// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// The samples around the boundary of a mask, in rings: ring 0 are the samples with a 6-neighbour
/// on the other side, and each next ring the neighbours of the last one. The rings of a sample of
/// ring 0 end where the surface near it is known; the last two are fixed.
struct Band {
  static constexpr std::uint32_t kOutside = 0xffffffff;
  static constexpr std::uint8_t kFixedRings = 2;

  std::vector<std::size_t> sample;  ///< per band sample, its index in the volume; ascending
  /// Per band sample, those at -x, +x, -y, +y, -z, +z; kOutside if they are not in the band.
  std::vector<std::array<std::uint32_t, 6>> neighbour;
  std::vector<std::uint8_t> is_inside;
  std::vector<float> distance;  ///< to the boundary: the nearest midpoint of a crossed grid edge,
                                ///< in units of the smallest spacing
  std::vector<float> margin;    ///< the least distance of the field from zero
  std::vector<std::uint8_t> rings_left;  ///< 1 and 2: fixed
  /// Bit k: there is a neighbour on both sides along axis k, so the second difference exists.
  /// 0 in the last ring.
  std::vector<std::uint8_t> axes;

  std::size_t size() const { return sample.size(); }
  bool is_fixed(std::size_t i) const { return rings_left[i] <= kFixedRings; }
};

/// Whether samples are at least twice as far apart along one axis as along another: then the
/// boundary is known at few places, and the field must be smooth over longer distances.
bool has_thick_slices(const Grid& grid);

/// @param inside  per sample, 1 inside, 0 outside
/// @throws Error(empty_surface) if there is no boundary; Error(unsupported) for 2^32 - 1 or more
///         band samples
/// @cost  O(N); 5 bytes per sample while it runs
Band make_band(const Grid& grid, std::span<const std::uint8_t> inside, const RunControl& control);

}  // namespace isoatlas::detail
