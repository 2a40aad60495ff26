// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <ranges>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "isoatlas/error.h"
#include "isoatlas/export.h"
#include "isoatlas/length_unit.h"

namespace isoatlas {

struct Vec3 {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

/// Native sample types; volumes are never converted whole.
enum class SampleType {
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64
};

ISOATLAS_API std::string_view name(SampleType type);  ///< "int8" ... "float64"
ISOATLAS_API std::size_t bytes_per_sample(SampleType type);

/// Where the samples of a volume sit in the world: world = origin + direction * (spacing * index).
/// The world is LPS for medical formats (as ITK gives it), else whatever the file says.
struct ISOATLAS_API Grid {
  std::array<std::size_t, 3> size{};  ///< samples along x, y, z; x runs fastest in memory
  Vec3 spacing{1, 1, 1};              ///< world length of one step along each axis, > 0
  Vec3 origin{};                      ///< world position of sample (0, 0, 0)
  std::array<Vec3, 3> direction{Vec3{1, 0, 0}, Vec3{0, 1, 0},
                                Vec3{0, 0, 1}};  ///< unit vector of the x, y and z axis (columns)
  LengthUnit unit = LengthUnit::unknown;         ///< of `spacing` and `origin`

  std::size_t sample_count() const { return size[0] * size[1] * size[2]; }
  double smallest_spacing() const;  ///< what "one voxel" (vx) means as a length
  bool mirrored() const;            ///< the direction's determinant is negative
  Vec3 to_world(Vec3 index) const;  ///< from sample-index coordinates to world coordinates
  Vec3 to_index(Vec3 world) const;  ///< back, for any direction that is not singular
};

/// Numbers of samples along x, y and z, from any integers. Throws Error(bad_argument) if one is
/// negative.
struct Size3 : std::array<std::size_t, 3> {
  Size3() : array{} {}
  Size3(const std::array<std::size_t, 3>& size) : array(size) {}
  template <std::integral X, std::integral Y, std::integral Z>
  Size3(X x, Y y, Z z) : array{from(x), from(y), from(z)} {}

 private:
  template <std::integral T>
  static std::size_t from(T n) {
    if (std::cmp_less(n, 0))
      throw Error(ErrorCode::bad_argument,
                  "a volume cannot have " + std::to_string(n) + " samples along an axis");
    return static_cast<std::size_t>(n);
  }
};

/// Steps in memory from a sample to the next one along x, y and z, in samples; may be negative.
using Strides = std::array<std::ptrdiff_t, 3>;

/// The type of samples that a C++ type is. Only these types have one.
template <class T>
concept Sample = std::same_as<T, std::int8_t> || std::same_as<T, std::uint8_t> ||
    std::same_as<T, float> || std::same_as<T, double> ||
    (std::integral<T> && !std::same_as<T, bool> && !std::same_as<T, char> && sizeof(T) >= 2 &&
     sizeof(T) <= 8);

template <Sample T>
constexpr SampleType sample_type_of() {
  constexpr int log_size = sizeof(T) == 1 ? 0 : sizeof(T) == 2 ? 1 : sizeof(T) == 4 ? 2 : 3;
  if constexpr (std::is_floating_point_v<T>)
    return sizeof(T) == 4 ? SampleType::float32 : SampleType::float64;
  return static_cast<SampleType>(2 * log_size + (std::is_signed_v<T> ? 0 : 1));
}

/// A volume that does not own its samples, which are in native byte order.
struct ISOATLAS_API VolumeView {
  Grid grid;
  SampleType type = SampleType::float32;
  const void* samples = nullptr;  ///< sample (0, 0, 0)
  Strides strides{};  ///< all 0: x fastest, without gaps; any other volume is copied once by each
                      ///< function, O(N)

  /// A view of a vector, span, array or other contiguous range of numbers, with spacing 1.
  /// @throws Error(bad_argument) if there are not size.x * size.y * size.z of them, x fastest
  template <std::ranges::contiguous_range Range>
  requires(Sample<std::ranges::range_value_t<Range>> &&
           (std::is_lvalue_reference_v<Range> ||
            std::ranges::borrowed_range<Range>)) static VolumeView
      of(Range&& samples, const Size3& size) {
    return of(std::span<const std::ranges::range_value_t<Range>>(samples), size, Strides{});
  }
  /// A view of samples in another order, or with gaps between them. `samples` starts with the
  /// sample that is first in memory.
  /// @throws Error(bad_argument) if a sample would be outside `samples`
  template <Sample T>
  static VolumeView of(std::span<const T> samples, const Size3& size, const Strides& strides) {
    VolumeView view;
    view.grid.size = size;
    view.type = sample_type_of<T>();
    view.strides = strides;
    view.samples = samples.data() + offset_of_first(samples.size(), size, strides);
    return view;
  }

  bool is_dense() const;  ///< x fastest, without gaps
  /// The box of samples from `first` to `last`, both in it, with its own origin. No copy.
  /// @throws Error(bad_argument) if it is empty or not inside
  VolumeView box(const Size3& first, const Size3& last) const;

 private:
  static std::size_t offset_of_first(std::size_t count, const Size3& size, const Strides& strides);
};

/// A volume that keeps its samples alive.
struct Volume {
  VolumeView view;
  std::shared_ptr<const void> owner;

  operator const VolumeView&() const& { return view; }
  operator VolumeView() && = delete;  ///< the view would outlive the samples
};

struct SampleSummary {
  double minimum = 0, maximum = 0;  ///< over finite samples
  std::size_t nan_count = 0, infinity_count = 0;
  std::array<std::size_t, 3>
      first_non_finite{};  ///< index (x, y, z) of the first one in memory order
  std::size_t finite_count = 0;
};

/// One pass over all samples, O(N).
ISOATLAS_API SampleSummary summarize(const VolumeView& volume);

/// Which samples are inside. A sample equal to the isovalue is inside either way:
/// above: value >= isovalue; below: value <= isovalue (the same as negating volume and isovalue).
enum class Inside { above, below };

/// What to do with NaN and infinite samples. `below` and `above` put NaN on that side of the
/// isovalue; infinities then keep the side their sign says.
enum class NonFinite { refuse, below, above };

/// What the surface is inside a cell. On the faces between cells it is that of the bilinear
/// interpolant.
enum class Topology : std::uint8_t {
  faces,      ///< one disk for every closed loop on the cell's boundary: the paper's surface
  trilinear,  ///< that of the trilinear interpolant: where it joins two loops by a tunnel, an
              ///< annulus instead of their two disks
};

/// Where the surface is between samples. Its topology is decided by the samples, whichever it is.
enum class Interpolation : std::uint8_t {
  trilinear,
  tricubic,  ///< Catmull-Rom splines along the three axes, samples beyond the border as on it:
             ///< smooth, and through the samples
};

/// Coordinates of the mesh. lps: the volume's world as ITK gives it; ras: the same with x and y
/// negated; voxel: sample-index coordinates, sample (0,0,0) at the origin.
enum class Space { lps, ras, voxel };

/// Which surface of a volume is meant.
struct SurfaceOptions {
  double isovalue = 0;
  Inside inside = Inside::above;
  NonFinite non_finite = NonFinite::refuse;
  Topology topology = Topology::trilinear;
  /// What is between samples, to place vertices, to measure distances and to supersample; not
  /// supersampled, the topology is the same.
  Interpolation interpolation = Interpolation::trilinear;
};

}  // namespace isoatlas
