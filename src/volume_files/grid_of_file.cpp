// SPDX-License-Identifier: Apache-2.0
#include "volume_files/grid_of_file.h"

#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <string>

#include "files/file_error.h"
#include "files/mapped_file.h"
#include "files/memory_limit.h"

namespace isoatlas::detail::io {

namespace {

// Headers hold rounded cosines. If a length differs from 1 by less than this, it is rounding, and
// the axis and the spacing stay as written: 0.8125 in the file is 0.8125 in the report.
constexpr double kUnitTolerance = 1e-6;

// |det| of three unit vectors below which the volume is considered flat.
constexpr double kSmallestDeterminant = 1e-4;

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Vec3 scaled(const Vec3& v, double factor) { return {v.x * factor, v.y * factor, v.z * factor}; }

double determinant(const std::array<Vec3, 3>& a) {
  return a[0].x * (a[1].y * a[2].z - a[1].z * a[2].y) -
         a[1].x * (a[0].y * a[2].z - a[0].z * a[2].y) +
         a[2].x * (a[0].y * a[1].z - a[0].z * a[1].y);
}

}  // namespace

Grid grid_of_file(const std::filesystem::path& path, const std::array<std::size_t, 3>& size,
                  const Vec3& spacing, const Vec3& origin, const std::array<Vec3, 3>& axes) {
  Grid grid;
  grid.size = size;
  grid.origin = origin;
  grid.direction = axes;
  grid.spacing = spacing;
  if (!is_finite(origin)) {
    throw bad_file(path, "the origin is not finite, expected three numbers");
  }
  const std::array<double*, 3> steps{&grid.spacing.x, &grid.spacing.y, &grid.spacing.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double& step = *steps[axis];
    Vec3& direction = grid.direction[axis];
    const std::string axis_name(1, "xyz"[axis]);
    const double length = std::hypot(direction.x, direction.y, direction.z);
    if (!std::isfinite(length) || length == 0) {
      throw bad_file(path, "the direction of the " + axis_name + " axis is not a direction");
    }
    if (!std::isfinite(step) || step == 0) {
      throw bad_file(path, "the spacing along " + axis_name + " is " + std::to_string(step) +
                               ", expected a positive length");
    }
    if (step < 0) {
      step = -step;
      direction = scaled(direction, -1);
    }
    if (std::abs(length - 1) > kUnitTolerance) {
      step *= length;
      direction = scaled(direction, 1 / length);
      if (!std::isfinite(step) || step == 0 || !is_finite(direction)) {
        throw bad_file(path, "the direction of the " + axis_name + " axis is out of range");
      }
    }
  }
  for (Vec3* v : {&grid.origin, &grid.direction[0], &grid.direction[1], &grid.direction[2]}) {
    *v = {v->x + 0.0, v->y + 0.0, v->z + 0.0};  // avoids "-0" in reports
  }
  if (std::abs(determinant(grid.direction)) < kSmallestDeterminant) {
    throw bad_file(path, "the direction matrix is singular: the three axes lie in a plane");
  }
  return grid;
}

std::uint64_t checked_sample_bytes(const std::filesystem::path& path,
                                   const std::array<std::size_t, 3>& size,
                                   std::size_t bytes_per_sample) {
  const std::string shape = std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " +
                            std::to_string(size[2]) + " samples";
  std::uint64_t bytes = bytes_per_sample;
  for (const std::size_t samples : size) {
    if (samples < 2) {
      throw unsupported(path,
                        "has " + shape + ", expected a 3-D volume with at least 2 along each axis");
    }
    if (bytes > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()) / samples) {
      throw bad_file(path, "the header states " + shape + ", more than any file can hold");
    }
    bytes *= samples;
  }
  return bytes;
}

void require_within_memory_limit(const std::filesystem::path& path, std::uint64_t bytes,
                                 const ReadOptions& options) {
  const std::uint64_t limit = options.max_memory == 0 ? default_memory_limit() : options.max_memory;
  if (bytes > limit) {
    throw Error(
        ErrorCode::out_of_memory,
        one_line(path.string() + ": its samples take " + std::to_string(bytes) +
                 " bytes, more than the limit of " + std::to_string(limit) +
                 (options.max_memory == 0 ? " bytes, three quarters of this machine's memory"
                                          : " bytes")),
        Remedy::allow_memory);
  }
}

std::shared_ptr<std::byte[]> mapped_samples(const std::filesystem::path& path, std::uint64_t offset,
                                            std::uint64_t bytes, std::size_t bytes_per_sample,
                                            const ReadOptions& options) {
  if (!options.map_samples || offset % bytes_per_sample != 0) return nullptr;
  return map_file(path, offset, bytes);
}

std::shared_ptr<std::byte[]> allocate_samples(const std::filesystem::path& path,
                                              std::uint64_t bytes, const ReadOptions& options) {
  if (options.map_samples) return memory_in_temporary_file(bytes);
  require_within_memory_limit(path, bytes, options);
  try {
    const std::shared_ptr<std::byte[]> samples(new std::byte[bytes]);
#ifdef ISOATLAS_FILL_SAMPLES
    static std::atomic<unsigned char> fill{
        0};  // samples that are not decoded differ from read to read, so tests detect them
    std::memset(samples.get(), ++fill, bytes);
#endif
    return samples;
  } catch (const std::bad_alloc&) {
    throw out_of_memory(path, bytes);
  }
}

}  // namespace isoatlas::detail::io
