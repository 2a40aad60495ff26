// SPDX-License-Identifier: Apache-2.0
#include "outputs/stated_rounding.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

namespace isoatlas::detail {
namespace {

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

/// The largest change of a quantity if vertices move by up to 1; 0 for quantities that are not
/// lengths.
double change_per_rounding(Quantity quantity) {
  switch (quantity) {
    case Quantity::max_distance:
    case Quantity::mean_distance:
      return 1;
    case Quantity::max_edge:
      return 2;
    case Quantity::min_edge:
      return -2;
    default:
      return 0;
  }
}

void state_rounding(LevelReport& level, double rounding, const std::string& path) {
  level.rounding = rounding;
  if (level.metrics) {
    for (std::size_t i = 0; i < kMetricCount; ++i) {
      const double change = rounding * change_per_rounding(static_cast<Quantity>(i));
      (*level.metrics)[i].maximum += change;
      (*level.metrics)[i].mean += change;
    }
  }
  if (level.distance_at_most) *level.distance_at_most += rounding;
  for (ConstraintResult& result : level.constraints) {
    const double change = rounding * change_per_rounding(result.constraint.quantity);
    result.reached = std::max(0.0, result.reached + change);
    const bool is_within = change >= 0 ? result.reached <= result.constraint.bound
                                       : result.reached >= result.constraint.bound;
    if (result.satisfied && change != 0 && !is_within) {
      result.satisfied = false;
      result.reason =
          "positions are rounded to float32 in " + path + ", by up to " + number(rounding);
    }
  }
}

}  // namespace

double rounding_in_world(double rounding, const Grid& grid, Space space) {
  return rounding *
         (space == Space::voxel ? std::max({grid.spacing.x, grid.spacing.y, grid.spacing.z}) : 1);
}

bool is_noticeable(double rounding_in_world, const Grid& grid) {
  constexpr double kShareOfAVoxel = 0.01;
  return rounding_in_world >= kShareOfAVoxel * grid.smallest_spacing();
}

void add_noticeable_rounding(Hierarchy& hierarchy, const ExtractReport& report, const Grid& grid) {
  for (std::size_t k = 0; k < hierarchy.levels.size(); ++k) {
    if (!is_noticeable(report.levels[k].rounding, grid)) continue;
    for (float& distance : hierarchy.levels[k].distance)
      distance += static_cast<float>(report.levels[k].rounding);
  }
}

void state_rounding(ExtractReport& report, const std::vector<FileRounding>& files, const Grid& grid,
                    Space space) {
  for (std::size_t k = 0; k < report.levels.size(); ++k) {
    const FileRounding* worst = nullptr;
    for (const FileRounding& file : files) {
      const bool has_level =
          std::find(file.levels.begin(), file.levels.end(), k) != file.levels.end();
      if (has_level && (worst == nullptr || file.largest > worst->largest)) worst = &file;
    }
    if (worst != nullptr && worst->largest > 0)
      state_rounding(report.levels[k], rounding_in_world(worst->largest, grid, space), worst->path);
  }
}

}  // namespace isoatlas::detail
