// SPDX-License-Identifier: Apache-2.0
// Where the samples of a NRRD file are, in LPS where the file says how its space lies in a body.
#pragma once

#include <array>
#include <filesystem>

#include "isoatlas/volume_file.h"
#include "volume_files/nrrd_header.h"

namespace isoatlas::detail::io {

/// The grid of three axes. What is assumed of them is added to the decisions and warnings of
/// `source`.
///
/// @param axes  those of the volume, fastest first
Grid nrrd_grid(const std::filesystem::path& path, const std::array<NrrdAxis, 3>& axes,
               const NrrdSpace& space, VolumeSource& source);

}  // namespace isoatlas::detail::io
