// SPDX-License-Identifier: Apache-2.0
// A volume at 1/2, 1/4, ... of its resolution, for meshes that have to be ready at once.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "isoatlas/volume.h"
#include "isoatlas/volume_file.h"

namespace isoatlas::detail::tool {

/// Each volume has the means of blocks of 2 x 2 x 2 samples of the previous one, at the centres of
/// the blocks. Means are of the finite samples; a block without any is NaN. An axis with fewer than
/// 8 samples is not reduced. Half a block at the end of an axis is left out.
class ReducedVolumes {
 public:
  /// @param whole  must outlive this object
  /// @cost  one pass over the N samples; a seventh of 4 N bytes
  explicit ReducedVolumes(const VolumeView& whole);

  /// Number of volumes, with the whole one.
  std::size_t count() const { return 1 + reduced_.size(); }

  /// The volume whose voxels are 2^halvings times as large, and of it the samples in a region.
  /// @param region  in samples of the whole volume
  /// @return none if fewer than two samples along an axis are left
  std::optional<VolumeView> at(std::size_t halvings, const Region& region) const;

 private:
  VolumeView whole_;
  std::vector<Volume> reduced_;
};

/// The number of pairs of neighbouring samples on different sides of the isovalue: about the number
/// of c-vertices of the isosurface.
/// @param every  counts in one of this number of slices across z, and multiplies
std::size_t count_crossings(const VolumeView& volume, double isovalue, std::size_t every = 1);

}  // namespace isoatlas::detail::tool
