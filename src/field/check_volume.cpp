// SPDX-License-Identifier: Apache-2.0
#include "field/check_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>

#include "core/ids.h"
#include "core/require.h"
#include "core/vector_math.h"
#include "field/sample_type.h"

namespace isoatlas::detail {
namespace {

constexpr double kMaxAnisotropy = 1e6;

// A voxel must have at least this many coordinates along an axis; otherwise distinct points of the
// mesh would coincide in the world.
constexpr double kMinSteps = 65536;

// Headers contain rounded cosines; up to this deviation lengths are right to a thousandth.
constexpr double kMaxShear = 1e-3;

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", x);
  return text;
}

bool is_finite(Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

// The distance between numbers of the size of x.
double step_at(double x) { return x - std::nextafter(x, 0.0); }

void check_reach(const Grid& grid) {
  Vec3 largest;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const auto at = [&](unsigned a) {
      return corner >> a & 1 ? static_cast<double>(grid.size[a] - 1) : 0.0;
    };
    const Vec3 p = grid.to_world({at(0), at(1), at(2)});
    require(is_finite(p),
            "with this spacing and origin the volume reaches beyond the range of numbers");
    largest = {std::max(largest.x, std::fabs(p.x)), std::max(largest.y, std::fabs(p.y)),
               std::max(largest.z, std::fabs(p.z))};
  }
  const Vec3 step{step_at(largest.x), step_at(largest.y), step_at(largest.z)};
  const std::array spacing{grid.spacing.x, grid.spacing.y, grid.spacing.z};
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3& d = grid.direction[a];
    const double along =
        std::fabs(d.x) * step.x + std::fabs(d.y) * step.y + std::fabs(d.z) * step.z;
    require(along <= spacing[a] / kMinSteps,
            std::string("spacing ") + number(spacing[a]) + " along " + "xyz"[a] +
                " is too small for coordinates this large: numbers there are " + number(along) +
                " apart");
  }
}

}  // namespace

void check_volume(const VolumeView& volume, double isovalue) {
  const Grid& grid = volume.grid;
  for (std::size_t a = 0; a < 3; ++a) {
    require(grid.size[a] >= 2 && grid.size[a] < kNone - 1,
            std::string("the volume has ") + std::to_string(grid.size[a]) + " samples along " +
                "xyz"[a] + ", expected 2 to 2^32 - 3");
  }
  const std::size_t max_samples = std::numeric_limits<std::ptrdiff_t>::max() / sizeof(double);
  require(grid.size[0] <= max_samples / grid.size[1] / grid.size[2],
          "a volume of " + std::to_string(grid.size[0]) + " x " + std::to_string(grid.size[1]) +
              " x " + std::to_string(grid.size[2]) + " samples is larger than any memory");
  for (const double s : {grid.spacing.x, grid.spacing.y, grid.spacing.z}) {
    require(std::isfinite(s) && s > 0, "spacing " + number(s) + " is not a positive length");
  }
  const double largest = std::max({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  require(largest <= kMaxAnisotropy * grid.smallest_spacing(),
          "spacings " + number(grid.smallest_spacing()) + " and " + number(largest) +
              " differ by more than a factor of " + number(kMaxAnisotropy));
  const auto& axes = grid.direction;
  require(is_finite(grid.origin) && is_finite(axes[0]) && is_finite(axes[1]) && is_finite(axes[2]),
          "origin and direction must be finite numbers");
  require(std::fabs(dot(axes[0], cross(axes[1], axes[2]))) > 1e-6,
          "the direction's axes lie in a plane");
  check_reach(grid);
  require(volume.samples != nullptr, "the volume has no samples");
  visit_sample_type(volume.type, [](auto*) {});  // throws if the type is unknown
  require(std::isfinite(isovalue), "the isovalue is not a finite number");
}

void require_orthonormal(const Grid& grid) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorCode::unsupported,
                what +
                    ", so lengths on it are not those of the world: refining and measuring need "
                    "unit vectors "
                    "at right angles",
                Remedy::only_coarse);
  };
  constexpr const char* kAxes = "xyz";
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3 axis = grid.direction[a], next = grid.direction[(a + 1) % 3];
    if (std::fabs(length(axis) - 1) > kMaxShear)
      refuse(std::string("the direction of the grid's ") + kAxes[a] + " axis has length " +
             number(length(axis)));
    const double cosine = dot(normalized(axis), normalized(next));
    if (std::fabs(cosine) <= kMaxShear) continue;
    const double degrees = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
    refuse(std::string("the grid is sheared (its ") + kAxes[a] + " and " + kAxes[(a + 1) % 3] +
           " axes are at " + number(std::round(10 * degrees) / 10) + " degrees)");
  }
}

void throw_empty_surface(const VolumeView& volume, double isovalue) {
  const SampleSummary s = summarize(volume);
  if (s.finite_count == 0)
    throw Error(ErrorCode::empty_surface, "no sample of the volume is finite");
  throw Error(ErrorCode::empty_surface, "no surface at isovalue " + number(isovalue) +
                                            ": samples range from " + number(s.minimum) + " to " +
                                            number(s.maximum) + ", so all of them are on one side");
}

}  // namespace isoatlas::detail
