// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "isoatlas/volume_file.h"

namespace isoatlas::detail::io {

/// Whether a region of the volume is read without the rest of the file: from Zarr folders and
/// HDF5 files.
bool reads_boxes(const std::filesystem::path& path, const ReadOptions& options);

/// read_volume_file() for these, but the volume has no samples (VolumeView::samples is null).
VolumeFile read_without_samples(const std::filesystem::path& path, const ReadOptions& options);

}  // namespace isoatlas::detail::io
