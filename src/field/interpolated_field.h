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

/// The field of a volume of any sample type between its samples, >= 0 inside and < 0 outside, at any point. Points are in sample-index
/// coordinates, supersampled in those of the upsampled samples; then too it is the volume's own interpolant.
/// Immutable; any number of threads may ask at once. The volume's samples must outlive it.
class InterpolatedField {
 public:
  /// @pre  every size >= 2, supersample >= 1
  /// @cost one pass over the samples if they are floating-point numbers and the rule admits NaN, else O(1)
  InterpolatedField(const VolumeView& volume, const InsideRule& rule, Interpolation interpolation = Interpolation::trilinear,
                    std::uint32_t supersample = 1);

  struct Value {
    double value;
    Vec3 gradient;  ///< per step of the sample index
  };
  /// A point outside the volume counts as the nearest one on its border. Between cells it is the upper cell's gradient; if tricubic, both
  /// cells have the same. Where samples of float64 are so large or small that products of them leave the range of double, value and
  /// gradient are scaled, both alike.
  Value at(Vec3 p) const;

  /// The cell that was asked for last: many points in a row are in the same one. Of one field.
  class Cursor {
    friend InterpolatedField;
    std::size_t first = static_cast<std::size_t>(-1);  // its first sample; none: no cell yet
    TrilinearCell cell{{}};
  };
  /// The same, faster where `cursor` was in the cell of `p` before.
  Value at(Vec3 p, Cursor& cursor) const;

  /// The field on the cell from the sample at `low` to the next ones, as a function of the way from there; nothing if it is not trilinear.
  std::optional<TrilinearCell> cell(Vec3 low) const;

  struct Range {
    Vec3 low, high;
  };
  /// Bounds on the gradient, per component, at all points of the box from `low` to `high`; outside the volume that of at(), so zero across
  /// the border. Exact but for rounding where the box is in one cell. O(cells that the box meets)
  /// @return nothing if the box meets more than `most_cells` cells, or the field is not trilinear
  std::optional<Range> gradient_range(Vec3 low, Vec3 high, std::size_t most_cells) const;

  /// What parsing saw at a sample, inside or outside; a little different, between the volume's samples, from what at() finds there.
  /// @param sample  whole coordinates
  double at_sample(Vec3 sample) const;

  /// Where it is zero on the grid edge from the sample at `low` to the next one along `axis`, as a share of the edge; nothing if it is not.
  std::optional<double> zero_on_edge(Vec3 low, int axis) const;

  /// The nearest point of the volume.
  Vec3 clamped(Vec3 p) const;
  Vec3 last() const { return last_; }  ///< the index of the last sample
  Interpolation interpolation() const { return interpolation_; }
  std::uint32_t supersample() const { return supersample_; }

 private:
  TrilinearCell cell_at(const std::array<std::size_t, 3>& c) const { return TrilinearCell(samples_->corners(first_sample(c))); }
  std::size_t first_sample(const std::array<std::size_t, 3>& c) const { return c[0] + size_[0] * (c[1] + size_[1] * c[2]); }
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
  std::optional<UpsampledField> upsampled_;  // supersampled only
  std::shared_ptr<const Samples> samples_;
};

}  // namespace isoatlas::detail
