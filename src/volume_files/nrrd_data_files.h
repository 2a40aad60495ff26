// SPDX-License-Identifier: Apache-2.0
// Locates the samples of a NRRD file: after its header, or in files that the header names.
#pragma once

#include <filesystem>
#include <vector>

#include "isoatlas/volume_file.h"
#include "volume_files/nrrd_header.h"
#include "volume_files/stored_samples.h"

namespace isoatlas::detail::io {

/// Fills the pieces, format and byte order of `stored`, whose axes are set. Warns in `source` if
/// the stated encoding is wrong.
/// @throws Error(bad_file), Error(unsupported) if the header does not locate the samples
void find_nrrd_samples(StoredSamples& stored, const NrrdHeader& header,
                       const std::filesystem::path& path, VolumeSource& source);

}  // namespace isoatlas::detail::io
