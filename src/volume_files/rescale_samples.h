// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "isoatlas/volume.h"

namespace isoatlas::detail::io {

/// The type of slope * stored value + intercept: the smallest integer type for all possible values
/// if slope and intercept are integers, otherwise float32. Stored values are integers of 8 or 16
/// bits.
SampleType rescaled_type(SampleType stored, double slope, double intercept);

/// Rescales `count` samples from `from` to `to`, which has the type rescaled_type().
void rescale_samples(SampleType stored, const std::byte* from, std::size_t count, double slope,
                     double intercept, std::byte* to);

}  // namespace isoatlas::detail::io
