// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace isoatlas::detail {

/// A sum of doubles whose error does not grow with the number of terms: Neumaier's variant of
/// Kahan's summation. The order of the terms determines the result.
class CompensatedSum {
 public:
  void add(double term) {
    const double sum = sum_ + term;
    lost_ += std::fabs(sum_) >= std::fabs(term) ? (sum_ - sum) + term : (term - sum) + sum_;
    sum_ = sum;
  }
  double value() const { return sum_ + lost_; }

 private:
  double sum_ = 0, lost_ = 0;
};

}  // namespace isoatlas::detail
