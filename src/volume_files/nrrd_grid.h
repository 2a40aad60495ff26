// SPDX-License-Identifier: Apache-2.0
// The geometry of a NRRD file, in LPS if the file states the orientation of its space in a body.
#pragma once

#include <array>
#include <filesystem>

#include "isoatlas/volume_file.h"
#include "volume_files/nrrd_header.h"

namespace isoatlas::detail::io {

/// The grid of three axes. Assumptions about them are added to the decisions and warnings of
/// `source`.
///
/// @param axes  the axes of the volume, fastest first
Grid nrrd_grid(const std::filesystem::path& path, const std::array<NrrdAxis, 3>& axes,
               const NrrdSpace& space, VolumeSource& source);

}  // namespace isoatlas::detail::io
