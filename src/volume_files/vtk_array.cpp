// SPDX-License-Identifier: Apache-2.0
#include "volume_files/vtk_array.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "field/sample_type.h"
#include "files/file_error.h"
#include "volume_files/choice.h"
#include "volume_files/grid_of_file.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kCellPrefix = "cell:";

bool has_both(const std::vector<VtkArray>& arrays) {
  const auto is_cell_data = [](const VtkArray& array) { return array.is_cell_data; };
  return std::ranges::any_of(arrays, is_cell_data) && !std::ranges::all_of(arrays, is_cell_data);
}

std::string description(const VtkArray& array, bool with_prefix) {
  const std::string prefix(array.is_cell_data && with_prefix ? kCellPrefix : "");
  const std::string components =
      array.components == 1 ? "" : ", " + std::to_string(array.components) + " components";
  return prefix + (array.name.empty() ? "(unnamed)" : one_line(array.name, 80)) + ": " +
         std::string(array.type.name()) + components;
}

// The arrays with the name `wanted`, arrays of points first.
std::optional<std::size_t> array_called(const std::vector<VtkArray>& arrays,
                                        const std::string& wanted) {
  for (const bool is_cell_data : {false, true}) {
    for (std::size_t i = 0; i < arrays.size(); ++i) {
      const bool has_name = arrays[i].name == wanted ||
                            (is_cell_data && std::string(kCellPrefix) + arrays[i].name == wanted);
      if (arrays[i].is_cell_data == is_cell_data && has_name) {
        return i;
      }
    }
  }
  return {};
}

// The array that is read without a choice; nothing if that is ambiguous.
std::optional<std::size_t> array_without_choice(const std::vector<VtkArray>& arrays) {
  const bool reads_cells =
      std::ranges::all_of(arrays, [](const VtkArray& array) { return array.is_cell_data; });
  std::vector<std::size_t> all, marked;
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    if (arrays[i].is_cell_data == reads_cells) {
      all.push_back(i);
      if (arrays[i].is_marked) {
        marked.push_back(i);
      }
    }
  }
  const std::vector<std::size_t>& candidates = marked.empty() ? all : marked;
  return candidates.size() == 1 ? std::optional(candidates.front()) : std::nullopt;
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

}  // namespace

bool is_ghost_array(const std::string& name) {
  return name == "vtkGhostType" || name == "vtkGhostLevels";
}

std::size_t choose_array(const fs::path& path, const std::vector<VtkArray>& arrays,
                         const ReadOptions& options, VolumeSource& source) {
  if (arrays.empty()) {
    throw unsupported(path, "has no array of numbers at its points or in its cells, expected one");
  }
  FileChoice choice{"array", {}, {}};
  const bool with_prefix = has_both(arrays);
  for (const VtkArray& array : arrays) {
    choice.entries.push_back(description(array, with_prefix));
  }
  const std::optional<std::size_t> found =
      options.array.empty() ? array_without_choice(arrays) : array_called(arrays, options.array);
  const std::size_t chosen = found ? take_choice(path, source, choice, found)
                                   : take_choice(path, source, choice, options.array);
  if (arrays.size() > 1) {
    source.decisions.push_back({"array", one_line(arrays[chosen].name)});
  }
  return chosen;
}

std::uint64_t choose_component(const fs::path& path, const VtkArray& array,
                               const ReadOptions& options, VolumeSource& source) {
  constexpr std::uint64_t kMostComponents = 1024;
  if (array.components < 1 || array.components > kMostComponents) {
    throw unsupported(path, "its array '" + one_line(array.name, 80) + "' has " +
                                std::to_string(array.components) +
                                " values per sample, expected 1 to " +
                                std::to_string(kMostComponents));
  }
  if (array.components == 1) {
    return 0;
  }
  FileChoice choice = numbered_choice("channel", static_cast<std::size_t>(array.components));
  for (std::size_t i = 0; i < std::min(choice.entries.size(), array.component_names.size()); ++i) {
    if (!array.component_names[i].empty()) {
      choice.entries[i] = array.component_names[i];
    }
  }
  return take_choice(path, source, std::move(choice), options.channel);
}

std::array<std::size_t, 3> VtkGrid::cells() const {
  std::array<std::size_t, 3> cells = points;
  for (std::size_t& count : cells) {
    count -= count > 0 ? 1 : 0;
  }
  return cells;
}

Grid sample_grid(const fs::path& path, const VtkGrid& grid, bool is_cell_data,
                 VolumeSource& source) {
  const std::array<double, 3> steps{grid.spacing.x, grid.spacing.y, grid.spacing.z};
  std::array<double, 3> origin{grid.origin.x, grid.origin.y, grid.origin.z};
  std::array<double, 3> first{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = static_cast<double>(grid.first[axis]) + (is_cell_data ? 0.5 : 0.0);
    const double offset = steps[axis] * first[axis];
    origin[0] += grid.axes[axis].x * offset;
    origin[1] += grid.axes[axis].y * offset;
    origin[2] += grid.axes[axis].z * offset;
  }
  source.origin_in_samples = {first[0], first[1], first[2]};
  if (is_cell_data) {
    source.decisions.push_back({"samples", "cell data, at the centres of the cells"});
  }
  const std::array<std::size_t, 3> size = is_cell_data ? grid.cells() : grid.points;
  checked_sample_bytes(path, size, 1);
  return grid_of_file(path, size, grid.spacing, {origin[0], origin[1], origin[2]}, grid.axes);
}

AxisCoordinates coordinates_of_axis(VtkValues& values, VtkType type, std::uint64_t count,
                                    bool is_text) {
  constexpr double kSixDigits = 5e-6;
  AxisCoordinates axis;
  axis.rounding = is_text                              ? kSixDigits
                  : type.sample == SampleType::float32 ? std::numeric_limits<float>::epsilon()
                                                       : 0;
  axis.values.resize(static_cast<std::size_t>(count));
  visit_sample_type(type.sample, [&](auto* sample) {
    std::vector<std::remove_const_t<std::remove_pointer_t<decltype(sample)>>> stored(
        axis.values.size());
    values.read(stored.data(), count);
    std::ranges::transform(stored, axis.values.begin(),
                           [](auto value) { return static_cast<double>(value); });
  });
  return axis;
}

EvenSteps even_steps(const fs::path& path, const AxisCoordinates& coordinates, char axis_name) {
  const std::vector<double>& values = coordinates.values;
  const std::string which = std::string("its ") + axis_name + " coordinates";
  if (values.size() < 2) {
    return {values.empty() ? 0 : values.front(), 1};  // too few samples, which is reported later
  }
  if (!std::ranges::all_of(values, [](double value) { return std::isfinite(value); })) {
    throw bad_file(path, which + " are not finite");
  }
  constexpr double kTolerance = 1e-3;    // of a step
  constexpr double kMaxRounding = 1e-2;  // of a step
  const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
  const double rounding =
      coordinates.rounding * std::max(std::abs(values.front()), std::abs(values.back()));
  const double tolerance =
      std::abs(step) * kTolerance + std::min(rounding, std::abs(step) * kMaxRounding);
  double smallest = values[1] - values[0], greatest = smallest, deviation = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    smallest = std::min(smallest, values[i] - values[i - 1]);
    greatest = std::max(greatest, values[i] - values[i - 1]);
    deviation =
        std::max(deviation, std::abs(values[i] - (values.front() + static_cast<double>(i) * step)));
  }
  if (!(deviation <= tolerance)) {
    throw unsupported(path, which + " are uneven: steps of " + shortest(smallest) + " and of " +
                                shortest(greatest) +
                                ", expected equal steps; resample it to an image first");
  }
  return {values.front(), step};
}

}  // namespace isoatlas::detail::io
