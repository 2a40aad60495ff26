// SPDX-License-Identifier: Apache-2.0
// The description of SCIFIO, with which ImageJ2 and Fiji write TIFF files: four lists with one
// entry per axis, "axes=X,Y,Z", "lengths=", "scales=" and "units=". Pages run along the axes after
// x and y in the listed order, the first fastest.
#include <string>
#include <utility>
#include <vector>

#include "files/file_error.h"
#include "isoatlas/length_unit.h"
#include "volume_files/key_value_lines.h"
#include "volume_files/tiff_stack.h"

namespace isoatlas::detail::io {

namespace {

std::vector<std::string> entries_of(const std::string& list) {
  std::vector<std::string> entries(1);
  for (const char c : list) {
    if (c == ',') {
      entries.emplace_back();
    } else {
      entries.back() += c;
    }
  }
  return entries;
}

struct Axis {
  std::string name;
  std::size_t length = 1;
  std::optional<double> scale;
  std::string unit;
};

std::vector<Axis> axes_of(const KeyValueLines& lines, const std::filesystem::path& path) {
  const std::vector<std::string> names = entries_of(lines.text("axes")),
                                 lengths = entries_of(lines.text("lengths"));
  std::vector<std::string> scales = entries_of(lines.text("scales")),
                           units = entries_of(lines.text("units"));
  if (names.size() < 2 || names[0] != "X" || names[1] != "Y" || lengths.size() != names.size()) {
    throw bad_file(path, "SCIFIO's description lists axes '" + one_line(lines.text("axes"), 80) +
                             "' of lengths '" + one_line(lines.text("lengths"), 80) +
                             "', expected a length for each, X and Y first");
  }
  scales.resize(names.size());
  units.resize(names.size());
  std::vector<Axis> axes;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::optional<double> scale = finite_number(scales[i]);
    axes.push_back({names[i], count_of_pages(lengths[i]).value_or(1),
                    scale && *scale > 0 ? scale : std::nullopt, units[i]});
  }
  return axes;
}

void set_geometry(const std::vector<Axis>& axes, TiffStack& stack, VolumeSource& source) {
  stack.unit = length_unit_named(axes[0].unit);
  bool is_scaled = stack.unit != LengthUnit::unknown;
  for (const Axis& axis : axes) {
    const std::size_t index = std::string("XYZ").find(axis.name);
    if (index == std::string::npos || !axis.scale) continue;
    const LengthUnit unit = length_unit_named(axis.unit);
    const bool is_convertible = unit != LengthUnit::unknown && stack.unit != LengthUnit::unknown;
    if (!is_convertible && axis.unit != axes[0].unit) {
      source.warnings.push_back(one_line("its " + axis.name + " axis is in '" + axis.unit +
                                         "' and its X axis in '" + axes[0].unit +
                                         "'; the numbers are used without conversion"));
    }
    stack.spacing[index] = *axis.scale * (is_convertible ? metres(unit) / metres(stack.unit) : 1);
    is_scaled = is_scaled || *axis.scale != 1;
  }
  if (!is_scaled) {
    stack.spacing = {};
  }
}

}  // namespace

std::optional<TiffStack> describe_scifio(TiffFile& tiff, VolumeSource& source) {
  const std::string description = tiff.description();
  if (!description.starts_with("SCIFIO=")) {
    return {};
  }
  const KeyValueLines lines(description);
  if (!lines.has("axes") || !lines.has("lengths")) {
    return {};
  }
  const std::vector<Axis> axes = axes_of(lines, tiff.path());
  TiffStack stack;
  stack.format = "SCIFIO TIFF";
  set_geometry(axes, stack, source);
  std::string order;
  for (std::size_t i = 2; i < axes.size(); ++i) {
    const Axis& axis = axes[i];
    const bool is_known = axis.name == "Z" || axis.name == "Channel" || axis.name == "Time";
    if (!is_known && axis.length > 1) {
      throw unsupported(tiff.path(), one_line("has an axis '" + axis.name + "' of " +
                                              std::to_string(axis.length) +
                                              " entries, expected X, Y, Z, Channel and Time only"));
    }
    if (is_known && order.find(axis.name[0]) == std::string::npos) {
      order += axis.name[0];
      (axis.name == "Z"         ? stack.slices
       : axis.name == "Channel" ? stack.channels
                                : stack.times) = axis.length;
    }
  }
  for (const char axis : std::string("CZT")) {
    order += order.find(axis) == std::string::npos ? std::string(1, axis) : "";
  }
  std::vector<std::size_t> pages = pages_without_previews(tiff, source);
  tiff.select(pages.front());
  if (stack.channels == tiff.format().values_per_sample) {
    stack.channels = 1;  // counted in pages; a page holds all channels
  }
  if (pages.size() != stack.channels * stack.slices * stack.times) {
    throw bad_file(tiff.path(), "SCIFIO's description states " +
                                    std::to_string(stack.channels * stack.slices * stack.times) +
                                    " pages, the file has " + std::to_string(pages.size()));
  }
  set_page_order(stack, order, std::move(pages));
  return stack;
}

}  // namespace isoatlas::detail::io
