// SPDX-License-Identifier: Apache-2.0
// Where the samples of a NRRD file are: after its header, or in files that the header names.
#pragma once

#include <filesystem>
#include <vector>

#include "isoatlas/volume_file.h"
#include "volume_files/nrrd_header.h"
#include "volume_files/stored_samples.h"

namespace isoatlas::detail::io {

/// Fills pieces, format and byte order of `stored`, whose axes are filled. Warns in `source` of an
/// encoding that is not true.
/// @throws Error(bad_file), Error(unsupported) if the header says nothing that could be
void find_nrrd_samples(StoredSamples& stored, const NrrdHeader& header,
                       const std::filesystem::path& path, VolumeSource& source);

}  // namespace isoatlas::detail::io
