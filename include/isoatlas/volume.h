// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

#include "isoatlas/export.h"
#include "isoatlas/length_unit.h"

namespace isoatlas {

struct Vec3 {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

/// Native sample types; volumes are never converted whole.
enum class SampleType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

ISOATLAS_API std::string_view name(SampleType type);  ///< "int8" ... "float64"
ISOATLAS_API std::size_t bytes_per_sample(SampleType type);

/// Where the samples of a volume sit in the world: world = origin + direction * (spacing * index).
/// The world is LPS for medical formats (as ITK gives it), else whatever the file says.
struct ISOATLAS_API Grid {
  std::array<std::size_t, 3> size{};                                           ///< samples along x, y, z; x runs fastest in memory
  Vec3 spacing{1, 1, 1};                                                       ///< world length of one step along each axis, > 0
  Vec3 origin{};                                                               ///< world position of sample (0, 0, 0)
  std::array<Vec3, 3> direction{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< unit vector of the x, y and z axis (columns)
  LengthUnit unit = LengthUnit::unknown;                                       ///< of `spacing` and `origin`

  std::size_t sample_count() const { return size[0] * size[1] * size[2]; }
  double smallest_spacing() const;  ///< what "one voxel" (vx) means as a length
  bool mirrored() const;            ///< the direction's determinant is negative
  Vec3 to_world(Vec3 index) const;  ///< from sample-index coordinates to world coordinates
  Vec3 to_index(Vec3 world) const;  ///< back, for any direction that is not singular
};

/// Somebody's samples, not owned. `samples` points at grid.sample_count() values of `type`, x fastest, native byte order.
struct VolumeView {
  Grid grid;
  SampleType type = SampleType::float32;
  const void* samples = nullptr;
};

/// A view that keeps its samples alive.
struct Volume : VolumeView {
  std::shared_ptr<const void> owner;
};

struct SampleSummary {
  double minimum = 0, maximum = 0;  ///< over finite samples
  std::size_t nan_count = 0, infinity_count = 0;
  std::array<std::size_t, 3> first_non_finite{};  ///< index (x, y, z) of the first one in memory order
  std::size_t finite_count = 0;
};

/// One pass over all samples, O(N).
ISOATLAS_API SampleSummary summarize(const VolumeView& volume);

/// Which samples are inside. A sample equal to the isovalue is inside either way:
/// above: value >= isovalue; below: value <= isovalue (the same as negating volume and isovalue).
enum class Inside { above, below };

/// What to do with NaN and infinite samples. `below` and `above` put NaN on that side of the isovalue; infinities then
/// keep the side their sign says.
enum class NonFinite { refuse, below, above };

/// What the surface is inside a cell. On the faces between cells it is that of the bilinear interpolant.
enum class Topology : std::uint8_t {
  faces,      ///< one disk for every closed loop on the cell's boundary: the paper's surface
  trilinear,  ///< that of the trilinear interpolant: where it joins two loops by a tunnel, an annulus instead of their two disks
};

/// Where the surface is between samples. Its topology is decided by the samples, whichever it is.
enum class Interpolation : std::uint8_t {
  trilinear,
  tricubic,  ///< Catmull-Rom splines along the three axes, samples beyond the border as on it: smooth, and through the samples
};

/// Coordinates of the mesh. lps: the volume's world as ITK gives it; ras: the same with x and y negated;
/// voxel: sample-index coordinates, sample (0,0,0) at the origin.
enum class Space { lps, ras, voxel };

}  // namespace isoatlas
