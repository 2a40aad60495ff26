// SPDX-License-Identifier: Apache-2.0
// Estimates the memory that supersampling needs, before it runs.
#pragma once

#include <cstdint>

#include "isoatlas/options.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// Estimates the peak memory of extract() in bytes: the samples of the volume, an eighth of a byte
/// per upsampled sample, and 250 bytes per upsampled grid cell that the surface crosses, or 700 if
/// levels are refined. The number of crossed grid cells grows with the square of the factor. The
/// measurements are in docs/theory/01-surface.md: smooth surfaces need less, noise up to a fifth
/// more.
/// @throws Error(unsupported) as extract() for samples that are not finite
/// @cost   one pass over the samples
std::uint64_t estimated_memory(const VolumeView& volume, const ExtractOptions& options,
                               const RunControl& control = {});

/// Checks that a supersampled volume fits into memory and has no more samples than possible.
/// Returns at once if the factor is 1.
/// @param  limit  bytes; 0: three quarters of the machine's memory
/// @return estimated_memory(), or 0 if the factor is 1
/// @throws Error(bad_argument) if not; the message gives the largest possible factor
std::uint64_t require_memory_for_supersampling(const VolumeView& volume,
                                               const ExtractOptions& options,
                                               std::uint64_t limit = 0,
                                               const RunControl& control = {});

}  // namespace isoatlas::detail
