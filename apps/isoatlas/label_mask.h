// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "isoatlas/volume.h"

namespace isoatlas::detail::tool {

/// A volume of uint8 samples on the same grid: 1 where `labels` equals `label`, else 0. Its
/// isosurface at 0.5 is the surface of the label.
/// @param labels  N samples of an integer type, dense
/// @throws Error(unsupported) if the samples are floating-point numbers
/// @throws Error(empty_surface) if no sample equals `label`; the message lists the labels
/// @cost O(N) time, N bytes
Volume label_mask(const VolumeView& labels, std::int64_t label);

}  // namespace isoatlas::detail::tool
