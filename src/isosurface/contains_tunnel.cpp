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
#include <optional>

namespace isoatlas::detail {
namespace {

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
  const Number m =
      bottom(j) * top(k) + top(j) * bottom(k) - bottom(r) * top(s) - top(r) * bottom(s);
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

}  // namespace

bool contains_tunnel(const Tunnel& tunnel, const std::array<ExactSample, 8>& samples,
                     const ExactSample& isovalue) {
  std::array<Rounded, 8> f;
  for (std::size_t i = 0; i < 8; ++i) f[i] = rounded_difference(samples[i], isovalue);
  if (const auto decided = decide(tunnel, f)) return *decided;

  std::array<ExactSample, 9> all;
  std::copy(samples.begin(), samples.end(), all.begin());
  all[8] = isovalue;
  const std::array<Integer, 9> integers = common_integers(all);
  std::array<Integer, 8> exact;
  for (std::size_t i = 0; i < 8; ++i) exact[i] = integers[i] - integers[8];
  return *decide(tunnel, exact);
}

}  // namespace isoatlas::detail
