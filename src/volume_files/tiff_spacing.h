// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isoatlas/volume_file.h"
#include "volume_files/tiff_stack.h"

namespace isoatlas::detail::io {

/// The spacing that the stack states, 1 along axes without one. Sets `source.has_spacing`, adds
/// decisions about the unit and the rescaling, and warns if only some axes have a spacing.
Vec3 take_spacing(const TiffStack& stack, VolumeSource& source);

}  // namespace isoatlas::detail::io
