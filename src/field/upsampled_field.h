// SPDX-License-Identifier: Apache-2.0
// A volume with interpolated samples between its own.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/exact_numbers.h"
#include "field/classify.h"
#include "field/field.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// Whether there are no more than 2^36 samples in all, and fewer than 2^32 - 2 along an axis. @pre
/// factor >= 1
bool can_be_upsampled(const Grid& grid, std::uint32_t factor);

/// The samples of an upsampled volume: its interpolant at `factor` points per step of the index, (n
/// - 1) * factor + 1 along an axis. They are float64, computed on demand with the same bits each
/// time, and never stored. Where the volume is constant they are constant, and trilinear ones lie
/// between the samples around them, both exactly; 64-bit integers of the volume are rounded.
///
/// Samples that are not finite are treated as in Field. The volume's samples must outlive it; any
/// number of threads may query it.
class UpsampledField {
 public:
  /// @pre    every size >= 2, factor >= 1
  /// @throws Error(bad_argument) too many samples along an axis or in all
  /// @cost   as for Field
  UpsampledField(const VolumeView& volume, const InsideRule& rule, Interpolation interpolation,
                 std::uint32_t factor);

  static constexpr bool kAnyRange = true;
  const std::array<std::size_t, 3>& size() const { return fine_; }

  // As in Field; x runs fastest.
  double operator[](std::size_t i) const { return sign_ * (sample(i) - rule_.isovalue); }
  ExactSample exact(std::size_t i) const { return sample(i); }
  double isovalue() const { return rule_.isovalue; }

  /// The values of a TricubicCell that equals the volume's tricubic interpolant in the cell that
  /// starts at `low`.
  /// @param flat  axes along which the result is to be constant
  std::array<double, 64> around(const std::array<std::size_t, 3>& low,
                                const std::array<bool, 3>& flat) const;

  /// One bit per upsampled sample. Cells of the volume that the samples around them prove to be on
  /// one side are not evaluated.
  /// @throws as classify()
  /// @cost   a few passes over the volume's samples; factor^3 samples per cell that may be crossed;
  ///         1/8 byte per upsampled sample
  SignBits classify(const RunControl& control) const;

 private:
  using Around = std::array<std::array<std::size_t, 4>, 3>;  // indices along the axes; trilinear
                                                             // interpolation uses the middle two
  struct Samples;
  template <class T>
  struct SamplesOf;
  struct Phase {  // a position between two samples
    double t;
    CubicWeights cubic;
  };
  using Spline = std::array<std::array<double, 4>,
                            4>;  // maps values around a cell to those around a part of it
  template <std::size_t W>
  struct Block;

  Around around_cell(const std::array<std::size_t, 3>& cell) const;
  double sample(std::size_t i) const;
  template <std::size_t W>
  double sample_in(const std::array<std::size_t, 3>& cell,
                   const std::array<std::size_t, 3>& phase) const;
  template <std::size_t W>
  Block<W> block_of(const std::array<std::size_t, 3>& cell) const;
  template <std::size_t W, std::size_t N>
  std::array<double, N> between(const std::array<double, W * N>& f, std::size_t phase) const;
  template <std::size_t W>
  void set_signs(const std::array<std::size_t, 3>& cell, SignBits& out) const;
  std::size_t phases(std::size_t cell, int axis) const {
    return cell + 1 == size_[static_cast<std::size_t>(axis)] ? 1 : factor_;
  }
  bool is_inside(double value) const {
    return rule_.inside == Inside::above ? value >= rule_.isovalue : value <= rule_.isovalue;
  }
  int side_of(double low, double high) const;

  VolumeView volume_;
  InsideRule rule_;
  Interpolation interpolation_;
  std::size_t factor_;
  std::array<std::size_t, 3> size_, fine_;
  double sign_;
  std::vector<Phase> phase_;
  std::vector<Spline> spline_;
  std::shared_ptr<const Samples> samples_;
};

}  // namespace isoatlas::detail
