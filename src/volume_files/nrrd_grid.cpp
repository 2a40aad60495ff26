// SPDX-License-Identifier: Apache-2.0
#include "volume_files/nrrd_grid.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "files/file_error.h"
#include "volume_files/grid_of_file.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

struct Placement {
  std::array<double, 3> spacing{1, 1, 1};
  std::array<double, 3> origin{};
  std::array<std::array<double, 3>, 3> directions{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
};

Vec3 as_vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

/// The placement that space directions state.
void place_in_space(Placement& placement, const fs::path& path, const std::array<NrrdAxis, 3>& axes,
                    const NrrdSpace& space) {
  if (space.dimension == 0) {
    throw unsupported(
        path, "states directions in a space without its dimension, expected 3, or 4 with time");
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<double>& step = axes[axis].direction;
    if (step.empty()) {
      throw bad_file(path, std::string("its header states no direction in space of the ") +
                               "xyz"[axis] + " axis");
    }
    if (space.dimension == 4 && step[3] != 0) {
      throw unsupported(
          path, std::string("its ") + "xyz"[axis] + " axis runs through both space and time");
    }
    placement.spacing[axis] = std::sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]);
    const double scale = 1 / placement.spacing[axis];
    placement.directions[axis] = {scale * step[0], scale * step[1], scale * step[2]};
  }
}

// Samples are at the centres of cells by default, as in Teem.
bool is_node_centered(const NrrdAxis& axis) { return axis.centering == "node"; }

/// The placement that spacings or axis mins and maxs state.
void place_along_axes(Placement& placement, const std::array<NrrdAxis, 3>& axes,
                      VolumeSource& source) {
  std::string missing, from_ends;
  for (std::size_t i = 0; i < 3; ++i) {
    const NrrdAxis& axis = axes[i];
    const bool has_ends = !std::isnan(axis.minimum) && !std::isnan(axis.maximum);
    const auto steps = static_cast<double>(axis.size - (is_node_centered(axis) ? 1 : 0));
    const double spacing =
        std::isnan(axis.spacing) && has_ends ? (axis.maximum - axis.minimum) / steps : axis.spacing;
    if (std::isnan(spacing)) {
      missing += "xyz"[i];
    } else {
      placement.spacing[i] = spacing;
    }
    if (std::isnan(axis.spacing) && has_ends) {
      from_ends +=
          std::string(from_ends.empty() ? "" : " ") + (is_node_centered(axis)   ? "node"
                                                       : axis.centering.empty() ? "cell (assumed)"
                                                                                : "cell");
    }
    if (!std::isnan(axis.minimum)) {
      placement.origin[i] =
          axis.minimum + (is_node_centered(axis) || std::isnan(spacing) ? 0 : spacing / 2);
    }
  }
  if (!from_ends.empty()) {
    source.decisions.push_back({"spacing", "from axis mins and maxs, centerings " + from_ends});
  }
  source.has_spacing = missing.size() < 3;
  if (!missing.empty() && missing.size() < 3) {
    source.warnings.push_back("states no spacing along " + missing + "; 1 is assumed");
  }
}

void turn_to_lps(Placement& placement, const NrrdSpaceName& space) {
  for (std::array<double, 3>* v : {&placement.origin, &placement.directions[0],
                                   &placement.directions[1], &placement.directions[2]}) {
    (*v)[0] *= space.x_to_lps;
    (*v)[1] *= space.y_to_lps;
  }
}

/// The unit that the space and the axes name, if it is the same for all.
LengthUnit stated_unit(const fs::path& path, const std::array<NrrdAxis, 3>& axes,
                       const NrrdSpace& space, std::string& unknown_name) {
  std::vector<std::string> names(
      space.units.begin(), space.units.begin() + static_cast<std::ptrdiff_t>(
                                                     std::min<std::size_t>(space.units.size(), 3)));
  if (std::ranges::all_of(names, &std::string::empty)) {
    names = {axes[0].unit, axes[1].unit, axes[2].unit};
  }
  LengthUnit unit = LengthUnit::unknown;
  for (const std::string& name : names) {
    const LengthUnit named = length_unit_named(name);
    if (named == LengthUnit::unknown) {
      unknown_name = name.empty() ? unknown_name : name;
    } else if (unit != LengthUnit::unknown && named != unit) {
      throw unsupported(path, "its axes have units of their own (" + std::string(symbol(unit)) +
                                  " and " + std::string(symbol(named)) +
                                  "), expected one unit of length");
    } else {
      unit = named;
    }
  }
  if (unit != LengthUnit::unknown && !unknown_name.empty()) {
    throw unsupported(path, "its axes have units of their own (" + std::string(symbol(unit)) +
                                " and '" + one_line(unknown_name, 40) +
                                "'), expected one unit of length");
  }
  return unit;
}

void decide_unit(Grid& grid, const fs::path& path, const std::array<NrrdAxis, 3>& axes,
                 const NrrdSpace& space, VolumeSource& source) {
  std::string unknown_name;
  grid.unit = stated_unit(path, axes, space, unknown_name);
  const NrrdWorld world =
      space.name.empty() ? NrrdWorld::right_handed : nrrd_space_named(path, space.name).world;
  if (grid.unit != LengthUnit::unknown) {
    source.decisions.push_back({"unit", std::string(symbol(grid.unit))});
  } else if (!unknown_name.empty()) {
    source.decisions.push_back(
        {"unit", "unknown: '" + one_line(unknown_name, 40) + "' is not a known unit of length"});
  } else if ((world == NrrdWorld::body || world == NrrdWorld::scanner) && source.has_spacing) {
    grid.unit = LengthUnit::millimetre;
    source.decisions.push_back({"unit", "mm, by the convention of " + one_line(space.name, 40)});
  }
}

}  // namespace

Grid nrrd_grid(const fs::path& path, const std::array<NrrdAxis, 3>& axes, const NrrdSpace& space,
               VolumeSource& source) {
  Placement placement;
  const bool has_directions =
      std::ranges::any_of(axes, [](const NrrdAxis& axis) { return !axis.direction.empty(); });
  const bool has_spacings =
      std::ranges::any_of(axes, [](const NrrdAxis& axis) { return !std::isnan(axis.spacing); });
  if (space.dimension != 0 && space.dimension != 3 && space.dimension != 4) {
    throw unsupported(path, "lies in a space of " + std::to_string(space.dimension) +
                                " dimensions, expected 3, or 4 with time");
  }
  if (has_directions) {
    place_in_space(placement, path, axes, space);
    if (has_spacings) {
      source.warnings.push_back(
          "states both spacings and space directions; the space directions are used");
    }
  } else {
    place_along_axes(placement, axes, source);
    if (!space.name.empty()) {
      source.warnings.push_back("states no space directions, axes along those of its space (" +
                                one_line(space.name, 40) + ") are assumed");
    }
  }
  if (space.origin.size() >= 3) {
    placement.origin = {space.origin[0], space.origin[1], space.origin[2]};
  }
  if (!space.name.empty()) {
    turn_to_lps(placement, nrrd_space_named(path, space.name));
    source.decisions.push_back({"space", one_line(space.name, 40)});
    if (nrrd_space_named(path, space.name).world == NrrdWorld::left_handed) {
      source.warnings.push_back(
          "lies in a left-handed space, which a program with right-handed coordinates shows "
          "mirrored");
    }
  }
  const std::array<std::size_t, 3> size{axes[0].size, axes[1].size, axes[2].size};
  Grid grid = grid_of_file(path, size, as_vector(placement.spacing), as_vector(placement.origin),
                           {as_vector(placement.directions[0]), as_vector(placement.directions[1]),
                            as_vector(placement.directions[2])});
  decide_unit(grid, path, axes, space, source);
  return grid;
}

}  // namespace isoatlas::detail::io
