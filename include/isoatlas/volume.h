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

/// A point or vector with three coordinates.
struct Vec3 {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

/// The types of samples. A volume keeps its samples in their own type; it is never converted as a
/// whole.
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

/// The name of a sample type: "int8" ... "float64".
ISOATLAS_API std::string_view name(SampleType type);
/// The size of a sample in bytes: 1, 2, 4 or 8.
ISOATLAS_API std::size_t bytes_per_sample(SampleType type);

/// Numbers of samples along x, y and z, or the index of a sample. It can be constructed from three
/// integers of any types; throws Error(bad_argument) if one is negative.
struct Size3 : std::array<std::size_t, 3> {
  Size3() : array{} {}
  Size3(const std::array<std::size_t, 3>& size) : array(size) {}
  template <std::integral X, std::integral Y, std::integral Z>
  Size3(X x, Y y, Z z) : array{from(x), from(y), from(z)} {}

 private:
  template <std::integral T>
  static std::size_t from(T n) {
    if (std::cmp_less(n, 0))
      throw Error(ErrorCode::bad_argument, "a number of samples or an index is " +
                                               std::to_string(n) + ", expected 0 or more");
    return static_cast<std::size_t>(n);
  }
};

/// The world positions of the samples of a volume: world = origin + direction * (spacing * index).
/// World coordinates are LPS for medical formats, as in ITK; for other formats they are those of
/// the file.
struct ISOATLAS_API Grid {
  Size3 size{};           ///< samples along x, y, z; x runs fastest in memory
  Vec3 spacing{1, 1, 1};  ///< world distance between samples along each axis, > 0
  Vec3 origin{};          ///< world position of sample (0, 0, 0)
  /// World unit vectors along the x, y and z axes of the volume: the columns of the direction
  /// matrix.
  std::array<Vec3, 3> direction{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  LengthUnit unit = LengthUnit::unknown;  ///< unit of `spacing` and `origin`

  std::size_t sample_count() const { return size[0] * size[1] * size[2]; }
  double smallest_spacing() const;  ///< the length of one voxel (vx), in world units
  bool mirrored() const;            ///< true if the determinant of `direction` is negative
  Vec3 to_world(Vec3 index) const;  ///< from sample-index coordinates to world coordinates
  Vec3 to_index(Vec3 world) const;  ///< inverse of to_world(); `direction` must not be singular
};

/// Distances in memory from a sample to the next one along x, y and z, counted in samples; may be
/// negative.
using Strides = std::array<std::ptrdiff_t, 3>;

/// C++ types that samples can have: integers of 1 to 8 bytes, except bool and char, and
/// floating-point numbers of 4 or 8 bytes.
template <class T>
concept Sample = std::same_as<T, std::int8_t> || std::same_as<T, std::uint8_t> ||
    std::same_as<T, float> || std::same_as<T, double> ||
    (std::integral<T> && !std::same_as<T, bool> && !std::same_as<T, char> && sizeof(T) >= 2 &&
     sizeof(T) <= 8);

/// The SampleType of a C++ type.
template <Sample T>
constexpr SampleType sample_type_of() {
  constexpr int log_size = sizeof(T) == 1 ? 0 : sizeof(T) == 2 ? 1 : sizeof(T) == 4 ? 2 : 3;
  if constexpr (std::is_floating_point_v<T>)
    return sizeof(T) == 4 ? SampleType::float32 : SampleType::float64;
  return static_cast<SampleType>(2 * log_size + (std::is_signed_v<T> ? 0 : 1));
}

/// A volume that does not own its samples. They are in native byte order and must outlive the view.
struct ISOATLAS_API VolumeView {
  Grid grid;
  SampleType type = SampleType::float32;
  const void* samples = nullptr;  ///< address of sample (0, 0, 0)
  /// All 0: x runs fastest, without gaps. With any other strides, each function of the library
  /// first makes a dense copy of the N samples, O(N).
  Strides strides{};

  /// A view of a vector, span, array or other contiguous range of numbers, with spacing 1.
  /// @param strides  default: x runs fastest, without gaps. Otherwise `samples` starts at the
  ///        sample with the lowest address; with negative strides this is not sample (0, 0, 0)
  /// @throws Error(bad_argument) if the range does not have size[0] * size[1] * size[2] numbers,
  ///         or with strides if a sample would be outside the range
  template <std::ranges::contiguous_range Range>
  requires(Sample<std::ranges::range_value_t<Range>> &&
           (std::is_lvalue_reference_v<Range> ||
            std::ranges::borrowed_range<Range>)) static VolumeView
      of(Range&& samples, const Size3& size, const Strides& strides = {}) {
    VolumeView view;
    view.grid.size = size;
    view.type = sample_type_of<std::ranges::range_value_t<Range>>();
    view.strides = strides;
    view.samples =
        std::ranges::data(samples) + offset_of_first(std::ranges::size(samples), size, strides);
    return view;
  }

  bool is_dense() const;  ///< true if x runs fastest, without gaps
  /// A view of the box of samples from `first` to `last`, both included; its origin is the world
  /// position of `first`. Nothing is copied.
  /// @throws Error(bad_argument) if the box is empty or not inside the volume
  VolumeView box(const Size3& first, const Size3& last) const;

 private:
  static std::size_t offset_of_first(std::size_t count, const Size3& size, const Strides& strides);
};

/// A volume that shares ownership of its samples.
struct Volume {
  VolumeView view;
  std::shared_ptr<const void> owner;

  /// A temporary volume can be an argument, as in `extract(sample(f, grid), 0)`. A reference or a
  /// view of it that is kept would outlive its samples.
  operator const VolumeView&() const& ISOATLAS_LIFETIMEBOUND { return view; }
  operator VolumeView() && = delete;
};

/// The range of a volume's samples, and the number of samples that are not finite.
struct SampleSummary {
  double minimum = 0, maximum = 0;  ///< over the finite samples
  std::size_t nan_count = 0, infinity_count = 0;
  /// Index (x, y, z) of the first sample that is not finite, in memory order.
  std::array<std::size_t, 3> first_non_finite{};
  std::size_t finite_count = 0;
};

/// Computes the summary in one pass over all N samples, O(N).
ISOATLAS_API SampleSummary summarize(const VolumeView& volume);

/// Which samples are inside the surface. A sample that equals the isovalue is inside in both cases.
enum class Inside {
  above,  ///< value >= isovalue
  below,  ///< value <= isovalue; the same as `above` for the negated volume and isovalue
};

/// How NaN and infinite samples are handled.
enum class NonFinite {
  refuse,  ///< functions throw Error(unsupported)
  below,   ///< NaN counts as below the isovalue; infinities are below or above it by their sign
  above,   ///< NaN counts as above the isovalue; infinities are below or above it by their sign
};

/// The surface inside a grid cell, the box between eight samples. On the faces of grid cells it is
/// always the isoline of the bilinear interpolant, which forms closed loops on the boundary of a
/// grid cell.
enum class Topology : std::uint8_t {
  faces,  ///< one disk per loop: the surface of the paper
  /// The topology of the trilinear interpolant: if it connects two loops by a tunnel, they bound
  /// one annulus instead of two disks.
  trilinear,
};

/// The interpolation between samples. It determines the position of the surface; its topology is
/// determined by the samples.
enum class Interpolation : std::uint8_t {
  trilinear,
  tricubic,  ///< Catmull-Rom splines along the three axes: smooth, and exact at the samples;
             ///< samples outside the volume are copies of the nearest sample
};

/// The coordinates of a mesh.
enum class Space {
  lps,    ///< world coordinates of the volume, as in ITK
  ras,    ///< world coordinates with x and y negated
  voxel,  ///< sample-index coordinates; sample (0, 0, 0) is at the origin
};

/// Selects an isosurface of a volume.
struct SurfaceOptions {
  double isovalue = 0;
  Inside inside = Inside::above;
  NonFinite non_finite = NonFinite::refuse;
  Topology topology = Topology::trilinear;
  /// Used to place vertices, to measure distances and to supersample. Without supersampling, it
  /// does not change the topology.
  Interpolation interpolation = Interpolation::trilinear;
};

}  // namespace isoatlas

// doxygen does not know std::tuple_size.
/// @cond
// `auto [nx, ny, nz] = volume.grid.size`
template <>
struct std::tuple_size<isoatlas::Size3> : std::integral_constant<std::size_t, 3> {};
template <std::size_t I>
struct std::tuple_element<I, isoatlas::Size3> {
  using type = std::size_t;
};
/// @endcond
