// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/exact_numbers.h"

namespace isoatlas::detail {

/// Exact sign (-1, 0, 1) of (a - q)(b - q) - (c - q)(d - q), the determinant of the asymptotic
/// decider (Nielson and Hamann 1991): a, b on one diagonal of a grid face, c, d on the other, q the
/// isovalue.
///
/// @pre  all arguments finite
/// @cost a floating-point filter nearly always decides; otherwise integers as long as necessary
int saddle_sign(const ExactSample& a, const ExactSample& b, const ExactSample& c,
                const ExactSample& d, const ExactSample& q);

}  // namespace isoatlas::detail
