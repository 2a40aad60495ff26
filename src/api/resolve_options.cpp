// SPDX-License-Identifier: Apache-2.0
#include "api/resolve_options.h"

#include <algorithm>
#include <string>

#include "isoatlas/error.h"

namespace isoatlas::detail {
namespace {

constexpr double kThickLayers = 4;  // layers count from so many smallest spacings on

void resolve(std::optional<Length>& length, const Grid& grid) {
  if (length && length->in_voxels) *length = length->value * grid.smallest_spacing();
}

}  // namespace

double default_voxel(const Grid& grid) {
  const double largest = std::max({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  return std::max(grid.smallest_spacing(), largest / kThickLayers);
}

LevelGoal in_world(LevelGoal goal, const Grid& grid) {
  for (Constraint& c : goal) {
    if (!c.in_voxels) continue;
    if (unit(c.quantity) != Unit::length)
      throw Error(ErrorCode::bad_argument, std::string(name(c.quantity)) + " is not a length: its bound cannot be in voxels");
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
