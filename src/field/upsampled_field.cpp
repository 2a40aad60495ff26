// SPDX-License-Identifier: Apache-2.0
// Based on:
//   [gavriliu2001]  section 3.2: the volume may be supersampled first, trilinear or tricubic.
// Ours: upsampled samples are not stored; interpolation along an axis starts from a sample and adds
// differences, so that a plateau at the isovalue stays a plateau; cells that cannot be crossed are
// skipped.
#include "field/upsampled_field.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

#include "core/ids.h"
#include "core/parallel.h"
#include "field/sample_type.h"

namespace isoatlas::detail {
namespace {

constexpr double kMaxSamples = 0x1p36;  // their sign bits take 8 GiB
constexpr double kHuge = 1e300, kShrink = 0x1p-10;
// Negative weights along an axis sum to at most 1/8 in magnitude, so over three axes to (1.25^3 -
// 1) / 2 = 0.477: no value exceeds those around it by more than this multiple of their range.
constexpr double kOvershoot = 0.48;
constexpr double kRounding =
    16 * std::numeric_limits<double>::epsilon();  // of the largest value, with a margin

void set_bits(std::uint64_t* bits, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end;) {
    const std::size_t b = i & 63, n = std::min(64 - b, end - i);
    bits[i >> 6] |= (n == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << n) - 1) << b;
    i += n;
  }
}

bool has_bit(const std::uint64_t* bits, std::size_t i) { return (bits[i >> 6] >> (i & 63)) & 1; }

double upsampled_samples(std::size_t samples, std::uint32_t factor) {
  return static_cast<double>(samples - 1) * factor + 1;
}

std::array<std::size_t, 3> upsampled_size(const Grid& grid, std::uint32_t factor) {
  if (!can_be_upsampled(grid, factor)) {
    throw Error(ErrorCode::bad_argument,
                std::to_string(grid.size[0]) + " x " + std::to_string(grid.size[1]) + " x " +
                    std::to_string(grid.size[2]) + " samples are too many to supersample by " +
                    std::to_string(factor) + ": 2^36 are possible, 2^32 - 3 along an axis");
  }
  std::array<std::size_t, 3> out;
  for (std::size_t a = 0; a < 3; ++a)
    out[a] = static_cast<std::size_t>(upsampled_samples(grid.size[a], factor));
  return out;
}

}  // namespace

bool can_be_upsampled(const Grid& grid, std::uint32_t factor) {
  double all = 1;
  for (const std::size_t n : grid.size) {
    const double upsampled = upsampled_samples(n, factor);
    if (upsampled >= kNone - 1) return false;
    all *= upsampled;
  }
  return all <= kMaxSamples;
}

// The operations that depend on the type of the samples.
struct UpsampledField::Samples {
  virtual ~Samples() = default;
  virtual void gather(const Around& at, std::array<double, 8>& out) const = 0;
  virtual void gather(const Around& at, std::array<double, 64>& out) const = 0;
  virtual void row(std::size_t y, std::size_t z, double* out) const = 0;
};

template <class T>
struct UpsampledField::SamplesOf : Samples {
  SamplesOf(const VolumeView& volume, const InsideRule& rule)
      : size(volume.grid.size), field(volume, rule) {}
  template <std::size_t W>
  void gather_cube(const Around& at, std::array<double, W * W * W>& out) const {
    constexpr std::size_t first = W == 2 ? 1 : 0;
    std::size_t n = 0;
    for (std::size_t k = first; k < first + W; ++k) {
      for (std::size_t j = first; j < first + W; ++j) {
        const std::size_t start = size[0] * (at[1][j] + size[1] * at[2][k]);
        for (std::size_t i = first; i < first + W; ++i) out[n++] = field.sample(start + at[0][i]);
      }
    }
  }
  void gather(const Around& at, std::array<double, 8>& out) const override {
    gather_cube<2>(at, out);
  }
  void gather(const Around& at, std::array<double, 64>& out) const override {
    gather_cube<4>(at, out);
  }
  void row(std::size_t y, std::size_t z, double* out) const override {
    const std::size_t start = size[0] * (y + size[1] * z);
    for (std::size_t x = 0; x < size[0]; ++x) out[x] = field.sample(start + x);
  }
  std::array<std::size_t, 3> size;
  Field<T> field;
};

// The values around a cell, z slowest, in multiples of `unit`.
template <std::size_t W>
struct UpsampledField::Block {
  std::array<double, W * W * W> f;
  double unit = 1;
  double in_range(double x) const {
    return std::clamp(unit * x, -std::numeric_limits<double>::max(),
                      std::numeric_limits<double>::max());
  }
};

UpsampledField::UpsampledField(const VolumeView& volume, const InsideRule& rule,
                               Interpolation interpolation, std::uint32_t factor)
    : volume_(volume),
      rule_(rule),
      interpolation_(interpolation),
      factor_(factor),
      size_(volume.grid.size),
      fine_(upsampled_size(volume.grid, factor)),
      sign_(rule.inside == Inside::above ? 1 : -1),
      samples_(
          visit_sample_type(volume.type, [&]<class T>(const T*) -> std::shared_ptr<const Samples> {
            return std::make_shared<SamplesOf<T>>(volume, rule);
          })) {
  const double step = 1.0 / factor;
  for (std::uint32_t p = 0; p <= factor; ++p) {
    const double t = static_cast<double>(p) / factor;
    phase_.push_back({t, CubicWeights(t)});
  }
  // The outer two of four values determine the slopes at the inner two.
  for (std::uint32_t p = 0; p < factor; ++p) {
    const CubicWeights &low = phase_[p].cubic, &high = phase_[p + 1].cubic;
    Spline& s = spline_.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      s[0][k] = high.value[k] - 2 * step * low.slope[k];
      s[1][k] = low.value[k];
      s[2][k] = high.value[k];
      s[3][k] = low.value[k] + 2 * step * high.slope[k];
    }
  }
}

UpsampledField::Around UpsampledField::around_cell(const std::array<std::size_t, 3>& cell) const {
  return {cubic_samples(cell[0], size_[0]), cubic_samples(cell[1], size_[1]),
          cubic_samples(cell[2], size_[2])};
}

template <std::size_t W>
UpsampledField::Block<W> UpsampledField::block_of(const std::array<std::size_t, 3>& cell) const {
  Block<W> block;
  samples_->gather(around_cell(cell), block.f);
  if (volume_.type == SampleType::float64) {
    const auto size_of = [](double a, double b) { return std::abs(a) < std::abs(b); };
    if (std::abs(*std::max_element(block.f.begin(), block.f.end(), size_of)) > kHuge) {
      block.unit = 1 / kShrink;
      for (double& x : block.f) x *= kShrink;
    }
  }
  return block;
}

// Interpolates along the slowest axis of W x N values.
template <std::size_t W, std::size_t N>
std::array<double, N> UpsampledField::between(const std::array<double, W * N>& f,
                                              std::size_t phase) const {
  std::array<double, N> out;
  if constexpr (W == 2) {
    const double t = phase_[phase].t;
    for (std::size_t i = 0; i < N; ++i) out[i] = f[i] + t * (f[i + N] - f[i]);
  } else {
    const std::array<double, 4>& w = phase_[phase].cubic.value;
    for (std::size_t i = 0; i < N; ++i) {
      const double base = f[i + N];
      out[i] = base +
               (w[0] * (f[i] - base) + w[2] * (f[i + 2 * N] - base) + w[3] * (f[i + 3 * N] - base));
    }
  }
  return out;
}

template <std::size_t W>
double UpsampledField::sample_in(const std::array<std::size_t, 3>& cell,
                                 const std::array<std::size_t, 3>& phase) const {
  const Block<W> block = block_of<W>(cell);
  return block.in_range(
      between<W, 1>(between<W, W>(between<W, W * W>(block.f, phase[2]), phase[1]), phase[0])[0]);
}

double UpsampledField::sample(std::size_t i) const {
  const std::array<std::size_t, 3> at{i % fine_[0], i / fine_[0] % fine_[1],
                                      i / fine_[0] / fine_[1]};
  const std::array<std::size_t, 3> cell{at[0] / factor_, at[1] / factor_, at[2] / factor_};
  const std::array<std::size_t, 3> phase{at[0] % factor_, at[1] % factor_, at[2] % factor_};
  return interpolation_ == Interpolation::trilinear ? sample_in<2>(cell, phase)
                                                    : sample_in<4>(cell, phase);
}

std::array<double, 64> UpsampledField::around(const std::array<std::size_t, 3>& low,
                                              const std::array<bool, 3>& flat) const {
  const std::array<std::size_t, 3> cell{low[0] / factor_, low[1] / factor_, low[2] / factor_};
  std::array<double, 64> f;
  samples_->gather(around_cell(cell), f);
  for (double& x : f) x = sign_ * (x - rule_.isovalue);
  f = rescaled(f);
  for (std::size_t a = 0, stride = 1; a < 3; ++a, stride *= 4) {
    const std::size_t phase = low[a] % factor_;
    std::array<double, 64> out;
    for (std::size_t i = 0; i < 64; ++i) {
      const std::size_t k = i / stride % 4, first = i - k * stride;
      const std::array<double, 4>& w = flat[a] ? phase_[phase].cubic.value : spline_[phase][k];
      out[i] = w[0] * f[first] + w[1] * f[first + stride] + w[2] * f[first + 2 * stride] +
               w[3] * f[first + 3 * stride];
    }
    f = out;
  }
  return f;
}

// 1: all samples of a cell are inside; -1: all are outside; 0: unknown. @param low, high  range of
// the samples around it
int UpsampledField::side_of(double low, double high) const {
  if (interpolation_ == Interpolation::tricubic && low < high) {
    const double beyond =
        kOvershoot * (high - low) + kRounding * std::max(std::abs(low), std::abs(high));
    low -= beyond;
    high += beyond;
  }
  const bool above = rule_.inside == Inside::above;
  if (above ? low >= rule_.isovalue : high <= rule_.isovalue) return 1;
  return (above ? high < rule_.isovalue : low > rule_.isovalue) ? -1 : 0;
}

template <std::size_t W>
void UpsampledField::set_signs(const std::array<std::size_t, 3>& cell, SignBits& out) const {
  const Block<W> block = block_of<W>(cell);
  const std::size_t first = cell[0] * factor_ + 1;
  for (std::size_t z = 0; z < phases(cell[2], 2); ++z) {
    const auto plane = between<W, W * W>(block.f, z);
    for (std::size_t y = 0; y < phases(cell[1], 1); ++y) {
      const auto line = between<W, W>(plane, y);
      std::uint64_t* bits =
          out.bits.data() +
          (cell[1] * factor_ + y + out.rows_y * (cell[2] * factor_ + z)) * out.words;
      for (std::size_t x = 0; x < phases(cell[0], 0); ++x) {
        if (is_inside(block.in_range(between<W, 1>(line, x)[0])))
          set_bits(bits, first + x, first + x + 1);
      }
    }
  }
}

SignBits UpsampledField::classify(const RunControl& control) const {
  if (rule_.non_finite == NonFinite::refuse &&
      (volume_.type == SampleType::float32 || volume_.type == SampleType::float64)) {
    isoatlas::detail::classify(volume_, rule_, control);  // only for its exceptions
  }
  const auto [nx, ny, nz] = size_;
  SignBits out;
  out.rows_y = fine_[1];
  out.words = (fine_[0] + 2 + 63) / 64;
  out.bits.resize(out.words * fine_[1] * fine_[2]);
  std::atomic<bool> any_inside{false}, any_outside{false};
  const bool cubic = interpolation_ == Interpolation::tricubic;
  // Calls f for the indices of the samples around the cells that start at i.
  const auto for_each_around = [&](std::size_t i, std::size_t n, auto f) {
    const auto samples_around = cubic_samples(i, n);
    for (std::size_t k = cubic ? 0 : 1; k < (cubic ? 4u : 3u); ++k) f(samples_around[k]);
  };
  for_each_chunk(nz, 1, [&, nx = nx, ny = ny, nz = nz](std::size_t z0, std::size_t z1) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    std::vector<double> row(nx), low(nx * ny), high(nx * ny), row_low(nx), row_high(nx);
    std::vector<std::uint64_t> known(out.words);
    std::vector<std::size_t> undecided;
    const auto widen = [nx](double* lowest, double* highest, const double* from_low,
                            const double* from_high) {
      for (std::size_t x = 0; x < nx; ++x) {
        lowest[x] = std::min(lowest[x], from_low[x]);
        highest[x] = std::max(highest[x], from_high[x]);
      }
    };
    for (std::size_t cz = z0; cz < z1; ++cz) {
      control.check_cancelled();
      std::fill(low.begin(), low.end(), kInfinity);
      std::fill(high.begin(), high.end(), -kInfinity);
      for_each_around(cz, nz, [&](std::size_t z) {
        for (std::size_t y = 0; y < ny; ++y) {
          samples_->row(y, z, row.data());
          widen(&low[nx * y], &high[nx * y], row.data(), row.data());
        }
      });
      for (std::size_t cy = 0; cy < ny; ++cy) {
        std::fill(row_low.begin(), row_low.end(), kInfinity);
        std::fill(row_high.begin(), row_high.end(), -kInfinity);
        for_each_around(cy, ny, [&](std::size_t y) {
          widen(row_low.data(), row_high.data(), &low[nx * y], &high[nx * y]);
        });
        std::fill(known.begin(), known.end(), std::uint64_t{0});
        undecided.clear();
        for (std::size_t cx = 0; cx < nx; ++cx) {
          double lowest = kInfinity, highest = -kInfinity;
          for_each_around(cx, nx, [&](std::size_t x) {
            lowest = std::min(lowest, row_low[x]);
            highest = std::max(highest, row_high[x]);
          });
          const int side = side_of(lowest, highest);
          if (side == 0) undecided.push_back(cx);
          if (side > 0) set_bits(known.data(), cx * factor_ + 1, cx * factor_ + 1 + phases(cx, 0));
        }
        const auto for_each_row = [&](auto f) {
          for (std::size_t z = cz * factor_; z < cz * factor_ + phases(cz, 2); ++z) {
            for (std::size_t y = cy * factor_; y < cy * factor_ + phases(cy, 1); ++y)
              f(out.bits.data() + (y + out.rows_y * z) * out.words);
          }
        };
        for_each_row([&](std::uint64_t* bits) { std::copy(known.begin(), known.end(), bits); });
        for (const std::size_t cx : undecided) {
          if (cubic) {
            set_signs<4>({cx, cy, cz}, out);
          } else {
            set_signs<2>({cx, cy, cz}, out);
          }
        }
        for_each_row([&](std::uint64_t* bits) {
          const std::size_t last = fine_[0];
          std::size_t inside = 0;
          for (std::size_t w = 0; w < out.words; ++w)
            inside += static_cast<std::size_t>(std::popcount(bits[w]));
          if (inside > 0) any_inside.store(true, std::memory_order_relaxed);
          if (inside < last) any_outside.store(true, std::memory_order_relaxed);
          if (has_bit(bits, 1)) set_bits(bits, 0, 1);
          if (has_bit(bits, last)) set_bits(bits, last + 1, last + 2);
        });
      }
    }
  });
  control.check_cancelled();
  out.any_inside = any_inside;
  out.any_outside = any_outside;
  return out;
}

}  // namespace isoatlas::detail
