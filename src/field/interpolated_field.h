// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "field/classify.h"
#include "field/field.h"
#include "field/upsampled_field.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// The field of a volume of any sample type between its samples, >= 0 inside and < 0 outside, at
/// any point. Points are in sample-index coordinates; with supersampling in those of the upsampled
/// samples, but the interpolant is that of the original volume. Immutable; any number of threads
/// may query it. The volume's samples must outlive it.
class InterpolatedField {
 public:
  /// @pre  every size >= 2, supersample >= 1
  /// @cost one pass over the samples if they are floating-point numbers and the rule admits NaN,
  ///       otherwise O(1)
  InterpolatedField(const VolumeView& volume, const InsideRule& rule,
                    Interpolation interpolation = Interpolation::trilinear,
                    std::uint32_t supersample = 1);

  struct Value {
    double value;
    Vec3 gradient;  ///< per step of the sample index
  };
  /// The field at a point. A point outside the volume is replaced by the nearest point on its
  /// boundary. Between two grid cells the gradient is that of the upper one; with tricubic
  /// interpolation both have the same. If samples of float64 are so large or small that products of
  /// them leave the range of double, value and gradient are scaled by the same factor.
  Value at(Vec3 p) const;

  /// Caches the last grid cell, because consecutive points are often in the same one. Use one
  /// cursor per field.
  class Cursor {
    friend InterpolatedField;
    std::size_t first =
        static_cast<std::size_t>(-1);  // its first sample; the default value: no cell yet
    TrilinearCell cell{{}};
  };
  /// at(p), but faster if the last point of `cursor` was in the same grid cell.
  Value at(Vec3 p, Cursor& cursor) const;

  /// The field in the grid cell that starts at the sample `low`, as a function of local
  /// coordinates; absent if the interpolation is not trilinear.
  std::optional<TrilinearCell> cell(Vec3 low) const;

  struct Range {
    Vec3 low, high;
  };
  /// Bounds on each component of the gradient in the box from `low` to `high`; outside the volume
  /// as for at(), so the component across the volume boundary is zero. Exact up to rounding if the
  /// box is inside one grid cell. O(grid cells that the box overlaps)
  /// @return absent if the box overlaps more than `max_cells` grid cells, or if the interpolation
  /// is
  ///         not trilinear
  std::optional<Range> gradient_range(Vec3 low, Vec3 high, std::size_t max_cells) const;

  /// The value that parsing used at a sample, inside or outside. With supersampling it may differ
  /// slightly from at() between the volume's samples.
  /// @param sample  whole coordinates
  double at_sample(Vec3 sample) const;

  /// The zero of the field on the grid edge from the sample at `low` to the next one along `axis`,
  /// as a share of the edge; absent if there is no zero.
  std::optional<double> zero_on_edge(Vec3 low, int axis) const;

  /// The nearest point inside the volume.
  Vec3 clamped(Vec3 p) const;
  Vec3 last() const { return last_; }  ///< index of the last sample
  Interpolation interpolation() const { return interpolation_; }
  std::uint32_t supersample() const { return supersample_; }

 private:
  TrilinearCell cell_at(const std::array<std::size_t, 3>& c) const {
    return TrilinearCell(samples_->corners(first_sample(c)));
  }
  std::size_t first_sample(const std::array<std::size_t, 3>& c) const {
    return c[0] + size_[0] * (c[1] + size_[1] * c[2]);
  }
  struct Samples {
    virtual ~Samples() = default;
    virtual double value(std::size_t sample) const = 0;
    virtual std::array<double, 8> corners(std::size_t first) const = 0;
    virtual std::array<double, 64> around(const std::array<std::size_t, 3>& cell) const = 0;
  };
  template <class T>
  struct SamplesOf;

  std::array<std::size_t, 3> size_;
  Vec3 last_;
  Interpolation interpolation_;
  std::uint32_t supersample_;
  std::optional<UpsampledField> upsampled_;  // only with supersampling
  std::shared_ptr<const Samples> samples_;
};

}  // namespace isoatlas::detail
