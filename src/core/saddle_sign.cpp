// SPDX-License-Identifier: Apache-2.0
// Exact sign of a 2x2 determinant of differences.
//
// Based on:
//   [shewchuk1997]  Adaptive precision floating-point arithmetic and fast robust geometric predicates, sections 2.1 to 2.5.
// Ours: all arithmetic is in long double, whose exponent range is so much larger than double's that
// neither products nor their rounding errors overflow or underflow for double inputs, and whose
// 64-bit mantissa holds 64-bit integers.
#include "core/saddle_sign.h"

#include <array>
#include <cfloat>
#include <cmath>
#include <cstddef>

static_assert(LDBL_MANT_DIG >= 64 && LDBL_MAX_EXP >= 16384, "saddle_sign needs a long double wider than double (x87 or IEEE quadruple)");

namespace isoatlas::detail {
namespace {

using Real = long double;

struct Two {
  Real high, low;  // high + low is the exact result, low the rounding error of high
};

Two two_sum(Real a, Real b) {
  const Real s = a + b;
  const Real bb = s - a;
  return {s, (a - (s - bb)) + (b - bb)};
}

Two two_product(Real a, Real b) {
  const Real p = a * b;
  return {p, std::fma(a, b, -p)};
}

// A sum of non-overlapping terms, smallest first; the last non-zero term has the sign of the sum.
struct Expansion {
  std::array<Real, 32> term{};
  std::size_t size = 0;

  void add(Real x) {  // grow-expansion with zero elimination
    std::size_t n = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const Two t = two_sum(x, term[i]);
      if (t.low != 0) term[n++] = t.low;
      x = t.high;
    }
    if (x != 0) term[n++] = x;
    size = n;
  }

  void add_product(Two a, Two b, Real sign) {
    for (const Real x : {a.low, a.high}) {
      for (const Real y : {b.low, b.high}) {
        const Two p = two_product(sign * x, y);
        add(p.low);
        add(p.high);
      }
    }
  }
};

int sign_of(Real x) { return (x > 0) - (x < 0); }

}  // namespace

int saddle_sign(long double a, long double b, long double c, long double d, long double q) {
  const Real left = (a - q) * (b - q);
  const Real right = (c - q) * (d - q);
  const Real det = left - right;
  // Each difference and each product is rounded once: the total error is below 4 ulp of |left| + |right|.
  const Real bound = 8 * LDBL_EPSILON * (std::fabs(left) + std::fabs(right));
  if (std::fabs(det) > bound) return sign_of(det);

  Expansion sum;
  sum.add_product(two_sum(a, -q), two_sum(b, -q), 1);
  sum.add_product(two_sum(c, -q), two_sum(d, -q), -1);
  return sum.size == 0 ? 0 : sign_of(sum.term[sum.size - 1]);
}

}  // namespace isoatlas::detail
