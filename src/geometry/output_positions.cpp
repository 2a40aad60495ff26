// SPDX-License-Identifier: Apache-2.0
#include "geometry/output_positions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/float32.h"
#include "core/vector_math.h"
#include "field/to_space.h"
#include "geometry/float32_origin.h"

namespace isoatlas::detail {
namespace {

constexpr double kMaxRounding = 0.001;  // in voxels

Bounds box_of(const Grid& grid, Space space) {
  std::array<Vec3, 8> corners;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const auto at = [&](unsigned a) {
      return corner >> a & 1 ? static_cast<double>(grid.size[a] - 1) : 0.0;
    };
    corners[corner] = to_space(grid, space, {at(0), at(1), at(2)});
  }
  return bounds_of(corners);
}

// The largest rounding of a coordinate of the volume to float32.
double rounding(const Bounds& box, Vec3 origin) {
  const double reach =
      std::max(largest_coordinate(box.low - origin), largest_coordinate(box.high - origin));
  if (!(reach < std::numeric_limits<float>::max())) return std::numeric_limits<double>::infinity();
  const double step = std::max(reach * std::numeric_limits<float>::epsilon(),
                               static_cast<double>(std::numeric_limits<float>::denorm_min()));
  return step / 2;
}

}  // namespace

Vec3 float32_origin(const Grid& grid, Space space) {
  return float32_origin_of(box_of(grid, space));
}

OutputPositions::OutputPositions(const Grid& grid, Space space, std::uint32_t supersample,
                                 Vec3 first)
    : grid_(grid), space_(space), steps_(supersample), first_(first) {
  std::vector<Vec3> origins{Vec3{}};
  if (const Vec3 other = float32_origin(grid, space); other != Vec3{}) origins.push_back(other);
  const Bounds box = box_of(grid, space);
  const double voxel = space == Space::voxel ? 1 : grid.smallest_spacing();
  for (const Vec3 origin : origins) {
    const double to_float = rounding(box, origin);
    if (!(to_float <= kMaxRounding * voxel)) continue;
    float32_origins_.push_back(origin);
    const double to_double = std::max(largest_coordinate(box.low), largest_coordinate(box.high)) *
                             std::numeric_limits<double>::epsilon();
    max_rounding_ =
        std::max(max_rounding_,
                 1.01 * (to_float + to_double));  // vertices are inside the box, up to rounding
  }
}

Vec3 OutputPositions::output_position(Vec3 index) const {
  const Vec3 in_block{index.x / steps_, index.y / steps_, index.z / steps_};
  return to_space(grid_, space_, first_ + in_block);
}

Vec3 OutputPositions::in_form(std::size_t form, Vec3 index) const {
  const Vec3 p = output_position(index);
  if (form == 0) return p;
  const Vec3 q = p - float32_origins_[form - 1];
  return {to_float32(q.x), to_float32(q.y), to_float32(q.z)};
}

std::vector<Vec3> OutputPositions::in_form(std::size_t form, std::span<const Vec3> indices) const {
  std::vector<Vec3> out;
  out.reserve(indices.size());
  for (const Vec3 index : indices) out.push_back(in_form(form, index));
  return out;
}

}  // namespace isoatlas::detail
