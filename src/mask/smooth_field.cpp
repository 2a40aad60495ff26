// SPDX-License-Identifier: Apache-2.0
#include "mask/smooth_field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"

namespace isoatlas::detail {
namespace {

// More steps bring no closer surface: the energy is within a few per mille of its minimum.
constexpr int kSteps = 40, kStepsForThickSlices = 100;
constexpr std::size_t kBandSamplesPerChunk = 1 << 14;

class FieldSolver {
 public:
  FieldSolver(const Band& band, const Grid& grid, const RunControl& control)
      : band_(band), control_(control) {
    const double h = grid.smallest_spacing();
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double ratio = h / std::array{grid.spacing.x, grid.spacing.y, grid.spacing.z}[a];
      weight_[a] = static_cast<float>(ratio * ratio);
      sum += ratio * ratio;
    }
    step_ = static_cast<float>(1 / (16 * sum * sum));
    steps_ = has_thick_slices(grid) ? kStepsForThickSlices : kSteps;
  }

  std::vector<float> run() {
    const std::size_t n = band_.size();
    field_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const float d = std::max(band_.distance[i], band_.margin[i]);
      field_[i] = band_.is_inside[i] != 0 ? d : -d;
    }
    ahead_ = field_;
    difference_.resize(n);
    next_.resize(n);
    double momentum = 1;
    for (int k = 0; k < steps_; ++k) {
      take_step();
      const bool restart = overshoot() > 0;
      const double following = restart ? 1 : (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
      const float share = restart ? 0.0f : static_cast<float>((momentum - 1) / following);
      momentum = following;
      for_each_index(n, kBandSamplesPerChunk, &control_, [&](std::size_t i) {
        ahead_[i] = next_[i] + share * (next_[i] - field_[i]);
        field_[i] = next_[i];
      });
    }
    return std::move(field_);
  }

 private:
  // The sum of second differences of `ahead_`.
  void find_differences() {
    for_each_index(band_.size(), kBandSamplesPerChunk, &control_, [&](std::size_t i) {
      float sum = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        if ((band_.axes[i] >> a & 1) == 0) continue;
        const std::uint32_t before = band_.neighbour[i][2 * a],
                            after = band_.neighbour[i][2 * a + 1];
        sum += weight_[a] * (ahead_[before] + ahead_[after] - 2 * ahead_[i]);
      }
      difference_[i] = sum;
    });
  }

  // The gradient is the transposed sum of second differences of `difference_`.
  void take_step() {
    find_differences();
    for_each_index(band_.size(), kBandSamplesPerChunk, &control_, [&](std::size_t i) {
      if (band_.is_fixed(i)) {
        next_[i] = field_[i];
        return;
      }
      float gradient = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const auto term = [&](std::uint32_t j) {
          return j != Band::kOutside && (band_.axes[j] >> a & 1) != 0 ? difference_[j] : 0.0f;
        };
        gradient +=
            weight_[a] * (term(band_.neighbour[i][2 * a]) + term(band_.neighbour[i][2 * a + 1]) -
                          2 * term(static_cast<std::uint32_t>(i)));
      }
      const float moved = ahead_[i] - step_ * gradient;
      next_[i] = band_.is_inside[i] != 0 ? std::max(moved, band_.margin[i])
                                         : std::min(moved, -band_.margin[i]);
    });
  }

  // > 0 if momentum carries the field beyond the minimum. Summed in a fixed order.
  double overshoot() {
    std::vector<double> sums((band_.size() + kBandSamplesPerChunk - 1) / kBandSamplesPerChunk, 0);
    for_each_index(sums.size(), 1, [&](std::size_t chunk) {
      const std::size_t end = std::min(band_.size(), (chunk + 1) * kBandSamplesPerChunk);
      double sum = 0;
      for (std::size_t i = chunk * kBandSamplesPerChunk; i < end; ++i)
        sum +=
            static_cast<double>(ahead_[i] - next_[i]) * static_cast<double>(next_[i] - field_[i]);
      sums[chunk] = sum;
    });
    double out = 0;
    for (const double s : sums) out += s;
    return out;
  }

  const Band& band_;
  const RunControl& control_;
  std::array<float, 3> weight_{};
  float step_ = 0;
  int steps_ = kSteps;
  std::vector<float> field_, ahead_, next_, difference_;
};

}  // namespace

std::vector<float> smooth_field(const Band& band, const Grid& grid, const RunControl& control) {
  return FieldSolver(band, grid, control).run();
}

}  // namespace isoatlas::detail
