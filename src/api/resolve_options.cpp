// SPDX-License-Identifier: Apache-2.0
#include "api/resolve_options.h"

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/vector_math.h"
#include "isoatlas/error.h"

namespace isoatlas::detail {
namespace {

constexpr double kThickLayers = 4;  // a layer is thick if it exceeds this many smallest spacings

void resolve(std::optional<Length>& length, const Grid& grid) {
  if (length && length->in_voxels) *length = length->value * grid.smallest_spacing();
}

// Inside the library a cell's points are index times spacing, in voxels.
std::shared_ptr<const CustomMetric> in_metric_coordinates(const CustomMetric& metric,
                                                          const Grid& grid) {
  const double voxel = grid.smallest_spacing();
  const bool is_mirrored = grid.mirrored();
  const auto direction = grid.direction;
  const Vec3 origin = grid.origin;
  const auto to_world_direction = [direction](Vec3 v) {
    return v.x * direction[0] + v.y * direction[1] + v.z * direction[2];
  };
  const auto to_world = [to_world_direction, origin, voxel](Vec3 point) {
    return origin + voxel * to_world_direction(point);
  };
  const auto value = [metric, to_world_direction, to_world, voxel,
                      is_mirrored](const CellGeometry& cell) {
    const auto mapped = [](std::span<const Vec3> from, const auto& map) {
      std::vector<Vec3> out;
      out.reserve(from.size());
      for (const Vec3& p : from) out.push_back(map(p));
      return out;
    };
    const std::vector<Vec3> points = mapped(cell.points, to_world),
                            normals = mapped(cell.normals, to_world_direction);
    std::vector<double> areas(cell.areas.begin(), cell.areas.end());
    for (double& area : areas) area *= voxel * voxel;
    std::vector<std::array<Vec3, 3>> triangles;
    triangles.reserve(cell.triangles.size());
    for (const auto& t : cell.triangles)
      triangles.push_back(
          {to_world(t[0]), to_world(t[is_mirrored ? 2 : 1]), to_world(t[is_mirrored ? 1 : 2])});
    return metric.value({to_world(cell.vertex), to_world_direction(cell.normal), points, normals,
                         areas, triangles});
  };
  return std::make_shared<const CustomMetric>(CustomMetric{metric.name, value});
}

}  // namespace

double default_voxel(const Grid& grid) {
  const double largest = std::max({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  return std::max(grid.smallest_spacing(), largest / kThickLayers);
}

LevelGoal in_world(LevelGoal goal, const Grid& grid) {
  for (Constraint& c : goal) {
    if (c.custom) {
      if (c.quantity != Quantity::custom || !c.custom->value)
        throw Error(ErrorCode::bad_argument,
                    "the metric " + c.custom->name +
                        " has no function, or is of another quantity than custom");
      c.custom = in_metric_coordinates(*c.custom, grid);
    }
    if (!c.in_voxels) continue;
    if (unit(c.quantity) != Unit::length)
      throw Error(ErrorCode::bad_argument, std::string(name(c.quantity)) +
                                               " is not a length: its bound cannot be in voxels");
    c.bound *= c.is_default ? default_voxel(grid) : grid.smallest_spacing();
    c.in_voxels = false;
  }
  return goal;
}

ExtractOptions in_world(ExtractOptions options, const Grid& grid) {
  options.coarse = in_world(std::move(options.coarse), grid);
  for (LevelGoal& goal : options.refine) goal = in_world(std::move(goal), grid);
  resolve(options.covering.max_radius, grid);
  resolve(options.covering.event_persistence, grid);
  return options;
}

}  // namespace isoatlas::detail
