// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// The preconditions of every computation on a volume.
/// @throws Error(bad_argument) size < 2 along an axis, spacing not positive or different by more
///         than 1e6 between axes, origin or direction not finite, direction singular, no samples,
///         unknown sample type; isovalue not finite
void check_volume(const VolumeView& volume, double isovalue);

/// An additional precondition of everything that reports world lengths, since these are computed
/// from the spacing alone.
/// @throws Error(unsupported) if the direction's axes are not unit vectors at right angles, to a
///         thousandth
void require_orthonormal(const Grid& grid);

/// Reports that there is no surface at an isovalue; one pass over the samples.
/// @throws Error(empty_surface) with the range of the samples
[[noreturn]] void throw_empty_surface(const VolumeView& volume, double isovalue);

}  // namespace isoatlas::detail
