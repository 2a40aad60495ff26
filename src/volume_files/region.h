// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "isoatlas/volume_file.h"

namespace isoatlas::detail::io {

/// The samples that ReadOptions::region selects, or all of them.
struct SelectedRegion {
  Size3 first{}, last{};  ///< both included
  Size3 size() const {
    return {last[0] - first[0] + 1, last[1] - first[1] + 1, last[2] - first[2] + 1};
  }
};

/// @param size    samples of the whole volume
/// @param source  gets the decision, if the options have a region
/// @throws Error(bad_argument) unless the region has two samples or more along each axis, in the
///         volume
SelectedRegion selected_region(const std::filesystem::path& path, const Size3& size,
                               const ReadOptions& options, VolumeSource& source);

/// The grid of a region of a volume. The region's first sample is added to
/// VolumeSource::origin_in_samples.
Grid grid_of_region(const Grid& whole, const SelectedRegion& region, VolumeSource& source);

}  // namespace isoatlas::detail::io
