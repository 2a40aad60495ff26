// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// What every computation on a volume asks of it.
/// @throws Error(bad_argument) size < 2 along an axis, spacing not positive or different by more than 1e6 between axes, origin or
///         direction not finite, direction singular, no samples, unknown sample type; isovalue not finite
void check_volume(const VolumeView& volume, double isovalue);

/// What everything that tells world lengths asks besides: it takes them from the spacing alone.
/// @throws Error(unsupported) if the direction's axes are not unit vectors at right angles, to a thousandth
void require_orthonormal(const Grid& grid);

/// For an isovalue that no surface belongs to; one pass over the samples.
/// @throws Error(empty_surface) saying the samples' range
[[noreturn]] void throw_empty_surface(const VolumeView& volume, double isovalue);

}  // namespace isoatlas::detail
