// SPDX-License-Identifier: Apache-2.0
// Supersampling takes memory that nobody expects: how much is said before, not found out.
#pragma once

#include <cstdint>

#include "isoatlas/options.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// Bytes that extract() takes at its peak, estimated: the volume's samples, an eighth of a byte for
/// each upsampled sample, and for each grid cell that the surface crosses, of which there are
/// supersample^2 as many as in the volume, 250 bytes, or 700 where levels are refined.
/// docs/theory/01-surface.md has the measurements behind it: smooth surfaces take less, noise up to
/// a fifth more.
/// @throws Error(unsupported) as extract() for samples that are not finite
/// @cost   one pass over the samples
std::uint64_t estimated_memory(const VolumeView& volume, const ExtractOptions& options,
                               const RunControl& control = {});

/// Refuses a factor of supersampling for which the memory does not suffice, or for which there are
/// too many samples; looks at nothing where the factor is 1.
/// @param  limit  bytes; 0: three quarters of the machine's
/// @return estimated_memory(), 0 where the factor is 1
/// @throws Error(bad_argument) that names the largest factor that is possible
std::uint64_t require_memory_for_supersampling(const VolumeView& volume,
                                               const ExtractOptions& options,
                                               std::uint64_t limit = 0,
                                               const RunControl& control = {});

}  // namespace isoatlas::detail
