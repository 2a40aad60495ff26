// SPDX-License-Identifier: Apache-2.0
#include "outputs/stated_rounding.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include "outputs/standard_output.h"

namespace isoatlas {
namespace {

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

/// How much a length of this kind can change if every vertex moves by 1; 0 for what is no length.
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
  for (ConstraintResult& result : level.constraints) {
    const double change = rounding * change_per_rounding(result.wanted.quantity);
    result.reached = std::max(0.0, result.reached + change);
    const bool is_within = change >= 0 ? result.reached <= result.wanted.bound : result.reached >= result.wanted.bound;
    if (result.met && change != 0 && !is_within) {
      result.met = false;
      result.reason = "positions are rounded to float32 in " + (is_standard_stream(path) ? kStandardOutputName : path) + ", by up to " + number(rounding);
    }
  }
}

}  // namespace

double rounding_in_world(const ReportFile& file, const Grid& grid, Space space) {
  const double sample = space == Space::voxel ? std::max({grid.spacing.x, grid.spacing.y, grid.spacing.z}) : 1;
  return file.largest_rounding * sample;
}

void state_rounding(ExtractReport& report, const std::vector<ReportFile>& files, const Grid& grid, Space space) {
  for (std::size_t k = 0; k < report.levels.size(); ++k) {
    const ReportFile* worst = nullptr;
    for (const ReportFile& file : files) {
      const bool has_level = std::find(file.levels.begin(), file.levels.end(), k) != file.levels.end();
      if (has_level && (worst == nullptr || file.largest_rounding > worst->largest_rounding)) worst = &file;
    }
    if (worst != nullptr && worst->largest_rounding > 0)
      state_rounding(report.levels[k], rounding_in_world(*worst, grid, space), worst->path);
  }
}

}  // namespace isoatlas
