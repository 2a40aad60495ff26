// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace isoatlas::detail {

/// Exact sign (-1, 0, 1) of (a - q)(b - q) - (c - q)(d - q), the determinant of the asymptotic
/// decider (Nielson and Hamann 1991): a, b on one diagonal of a grid face, c, d on the other, q the
/// isovalue.
///
/// @pre  all arguments finite, |.| <= 2^63 or any double that is not within a factor 4 of overflow
///       of long double
/// @cost a floating-point filter nearly always decides; otherwise exact expansions
int saddle_sign(long double a, long double b, long double c, long double d, long double q);

}  // namespace isoatlas::detail
