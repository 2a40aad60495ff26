// SPDX-License-Identifier: Apache-2.0
// Positions as files have them: what is promised of a mesh is promised of what is written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "isoatlas/extract.h"

namespace isoatlas {

/// A position in sample indices as one in that space. The same bits wherever it is asked.
Vec3 to_space(const Grid& grid, Space space, Vec3 index);

/// Where files that keep positions as float32 count them from if they have a choice (the translation in a .glb): the middle of the volume
/// if that is farther from the origin than the volume is long; else the origin. Its coordinates are float32 values.
Vec3 float32_origin(const Grid& grid, Space space);

/// Brings positions from sample indices into the forms in which files have them, to the last bit. Form 0 is the output's space in double
/// precision. The others are float32 as .stl (from the origin) and .glb (from float32_origin()) have it, unless that rounds by more
/// than a thousandth of a voxel: no refinement can help there.
class WrittenPositions {
 public:
  /// Sample indices as they are.
  WrittenPositions() = default;
  /// @param supersample  indices are those of so many samples for each one of the grid
  WrittenPositions(const Grid& grid, Space space, std::uint32_t supersample);

  Vec3 in_space(Vec3 index) const;  ///< form 0
  std::size_t form_count() const { return 1 + float32_origins_.size(); }
  /// @return as doubles; those of a float32 form without its origin
  std::vector<Vec3> in_form(std::size_t form, std::span<const Vec3> indices) const;

 private:
  Grid grid_;
  Space space_ = Space::voxel;
  double steps_ = 1;
  std::vector<Vec3> float32_origins_;
};

}  // namespace isoatlas
