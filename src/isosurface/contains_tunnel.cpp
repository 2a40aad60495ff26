// SPDX-License-Identifier: Apache-2.0
// The tunnel test, derived in docs/theory/01-surface.md.
//
// In the slice at height z the corners are linear in z; E(z) = product of the two joined ones -
// product of the two of the ring is a quadratic, and the sign of E determines which pair the slice
// joins. By the table the ring is joined at both ends of the heights where the two pairs have
// opposite signs; so the cell contains the tunnel iff E has its maximum among these heights and is
// positive there. With E = c (1-z)^2 + m z (1-z) + d z^2 this means: slopes m - 2c > 0 at the
// bottom and m - 2d > 0 at the top, m^2 - 4cd > 0, and the right signs of the corners at the
// maximum, z = (m - 2c) / ((m - 2c) + (m - 2d)).
#include "isosurface/contains_tunnel.h"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cfloat>
#include <climits>
#include <cmath>
#include <optional>

static_assert(LDBL_MANT_DIG >= 64 && LDBL_MAX_EXP >= 16384, "needs a long double wider than double (x87 or IEEE quadruple)");

namespace isoatlas::detail {
namespace {

using Real = long double;
using Integer = boost::multiprecision::cpp_int;

// A number and a bound of its error. The bounds use twice the unit of rounding, which more than
// compensates for their own rounding. Products of four doubles neither overflow nor underflow.
struct Rounded {
  Real value, error;

  friend Rounded operator+(Rounded a, Rounded b) { return rounded(a.value + b.value, a.error + b.error); }
  friend Rounded operator-(Rounded a, Rounded b) { return rounded(a.value - b.value, a.error + b.error); }
  friend Rounded operator*(Rounded a, Rounded b) {
    return rounded(a.value * b.value, std::fabs(a.value) * b.error + std::fabs(b.value) * a.error + a.error * b.error);
  }
  static Rounded rounded(Real value, Real error) { return {value, error + LDBL_EPSILON * (std::fabs(value) + error)}; }
};

std::optional<int> sign_of(const Rounded& x) {
  if (std::fabs(x.value) > x.error) return x.value > 0 ? 1 : -1;
  if (x.error == 0) return 0;
  return {};
}
std::optional<int> sign_of(const Integer& x) { return x.sign(); }

// f: corners minus the isovalue. Returns nothing if a sign is beyond the precision of Number.
template <class Number>
std::optional<bool> decide(const Tunnel& t, const std::array<Number, 8>& f) {
  // The polynomials of E; the height of a corner is bottom + z (top - bottom).
  const auto bottom = [&](int vertical) { return f[static_cast<std::size_t>(vertical)]; };
  const auto top = [&](int vertical) { return f[static_cast<std::size_t>(vertical) + 4]; };
  const auto [j, k] = t.joined;
  const auto [r, s] = t.ring;
  const Number c = bottom(j) * bottom(k) - bottom(r) * bottom(s);
  const Number d = top(j) * top(k) - top(r) * top(s);
  const Number m = bottom(j) * top(k) + top(j) * bottom(k) - bottom(r) * top(s) - top(r) * bottom(s);
  const Number rise = m - (c + c), fall = m - (d + d);
  for (const Number* slope : {&rise, &fall}) {
    const auto sign = sign_of(*slope);
    if (!sign) return {};
    if (*sign <= 0) return false;
  }
  const Number two_c = c + c, two_d = d + d;
  const auto discriminant = sign_of(Number(m * m - two_c * two_d));
  if (!discriminant) return {};
  if (t.inside ? *discriminant < 0 : *discriminant <= 0) return false;
  for (const auto& [pair, inside] : {std::pair{t.joined, t.inside}, {t.ring, !t.inside}}) {
    for (const int vertical : pair) {
      const auto sign = sign_of(Number(bottom(vertical) * fall + top(vertical) * rise));
      if (!sign) return {};
      if ((*sign >= 0) != inside) return false;
    }
  }
  return true;
}

// Converts doubles and 64-bit integers to integers, all multiplied by the same power of two.
std::array<Integer, 8> integers(const std::array<Real, 8>& samples, Real isovalue) {
  int least_exponent = INT_MAX;
  const auto update_least = [&](Real x) {
    int exponent = 0;
    std::frexp(x, &exponent);
    if (x != 0) least_exponent = std::min(least_exponent, exponent - LDBL_MANT_DIG);
  };
  std::for_each(samples.begin(), samples.end(), update_least);
  update_least(isovalue);
  const auto integer = [&](Real x) {
    int exponent = 0;
    const Real mantissa = std::frexp(x, &exponent);
    if (x == 0) return Integer(0);
    return Integer(Integer(std::ldexp(mantissa, LDBL_MANT_DIG)) << static_cast<unsigned>(exponent - LDBL_MANT_DIG - least_exponent));
  };
  std::array<Integer, 8> out;
  for (std::size_t i = 0; i < 8; ++i) out[i] = integer(samples[i]) - integer(isovalue);
  return out;
}

}  // namespace

bool contains_tunnel(const Tunnel& tunnel, const std::array<long double, 8>& samples, long double isovalue) {
  std::array<Rounded, 8> f;
  for (std::size_t i = 0; i < 8; ++i) f[i] = Rounded::rounded(samples[i] - isovalue, 0);
  if (const auto decided = decide(tunnel, f)) return *decided;
  return *decide(tunnel, integers(samples, isovalue));
}

}  // namespace isoatlas::detail
