// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isoatlas/volume_file.h"
#include "volume_files/tiff_stack.h"

namespace isoatlas::detail::io {

/// The spacing that the stack states, 1 where it states none. Sets `source.has_spacing`, adds
/// decisions on the unit and the rescale, and warns where it states only some.
Vec3 take_spacing(const TiffStack& stack, VolumeSource& source);

}  // namespace isoatlas::detail::io
