// SPDX-License-Identifier: Apache-2.0
#include "core/saddle_sign.h"

namespace isoatlas::detail {

int saddle_sign(const ExactSample& a, const ExactSample& b, const ExactSample& c,
                const ExactSample& d, const ExactSample& q) {
  const auto difference = [&](const ExactSample& x) { return rounded_difference(x, q); };
  if (const auto sign = sign_of(difference(a) * difference(b) - difference(c) * difference(d)))
    return *sign;
  const auto [i, j, k, l, m] = common_integers(std::array{a, b, c, d, q});
  return Integer((i - m) * (j - m) - (k - m) * (l - m)).sign();
}

}  // namespace isoatlas::detail
