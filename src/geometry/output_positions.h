// SPDX-License-Identifier: Apache-2.0
// Positions as files store them. Guarantees about a mesh hold for these coordinates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// The translation of a .glb: the centre of the volume if the volume is farther from the origin
/// than it is long, otherwise 0. Its coordinates are float32 values.
Vec3 float32_origin(const Grid& grid, Space space);

/// Converts sample-index coordinates to the coordinates that files store, bit by bit. Form 0 is the
/// output space in double precision. The other forms are float32 as in .stl (relative to the
/// origin) and in .glb (relative to float32_origin()). A float32 form that rounds by more than a
/// thousandth of a voxel is left out: smaller cells would cause more self-intersections there, not
/// fewer.
class OutputPositions {
 public:
  /// Form 0 equals the sample-index coordinates.
  OutputPositions() = default;
  /// @param supersample  indices refer to this many samples per sample of the grid
  /// @param first        the sample of the grid that has index 0: not 0 for a block of a volume
  OutputPositions(const Grid& grid, Space space, std::uint32_t supersample, Vec3 first = {});

  Vec3 output_position(Vec3 index) const;  ///< form 0
  std::size_t form_count() const { return 1 + float32_origins_.size(); }
  /// @return as doubles; of a float32 form relative to its origin
  Vec3 in_form(std::size_t form, Vec3 index) const;
  std::vector<Vec3> in_form(std::size_t form, std::span<const Vec3> indices) const;
  /// Upper bound of the difference of a coordinate in any form from form 0, apart from the origin.
  double max_rounding() const { return max_rounding_; }

 private:
  Grid grid_;
  Space space_ = Space::voxel;
  double steps_ = 1;
  Vec3 first_;
  std::vector<Vec3> float32_origins_;
  double max_rounding_ = 0;
};

}  // namespace isoatlas::detail
