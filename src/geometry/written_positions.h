// SPDX-License-Identifier: Apache-2.0
// Positions as files store them: what is promised of a mesh holds for the written coordinates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// The translation of a .glb: the middle of the volume if the volume is farther from the origin than it is long, else 0. Its coordinates
/// are float32 values.
Vec3 float32_origin(const Grid& grid, Space space);

/// Converts sample indices to the coordinates that files store, bit by bit. Form 0 is the output space in double precision. The other forms
/// are float32 as in .stl (relative to the origin) and in .glb (relative to float32_origin()). A float32 form that rounds by more than a
/// thousandth of a voxel is left out: smaller cells would cause more self-intersections there, not fewer.
class WrittenPositions {
 public:
  /// Sample indices as they are.
  WrittenPositions() = default;
  /// @param supersample  indices are those of so many samples for each one of the grid
  WrittenPositions(const Grid& grid, Space space, std::uint32_t supersample);

  Vec3 in_space(Vec3 index) const;  ///< form 0
  std::size_t form_count() const { return 1 + float32_origins_.size(); }
  /// @return as doubles; those of a float32 form without its origin
  Vec3 in_form(std::size_t form, Vec3 index) const;
  std::vector<Vec3> in_form(std::size_t form, std::span<const Vec3> indices) const;
  /// How far a coordinate in any form is from that of form 0, at most, apart from the origin.
  double most_rounding() const { return most_rounding_; }

 private:
  Grid grid_;
  Space space_ = Space::voxel;
  double steps_ = 1;
  std::vector<Vec3> float32_origins_;
  double most_rounding_ = 0;
};

}  // namespace isoatlas::detail
