// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>
#include <vector>

#include "files/file_error.h"
#include "volume_files/choice.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/header_text.h"
#include "volume_files/nrrd_data_files.h"
#include "volume_files/nrrd_grid.h"
#include "volume_files/nrrd_header.h"
#include "volume_files/readers.h"
#include "volume_files/stored_samples.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

enum class AxisRole { space, time, layer, channel, nothing };

bool is_domain(const NrrdAxis& axis) {
  return axis.kind.empty() || axis.kind == "domain" || axis.kind == "space";
}

// The role of an axis whose kind is domain or missing. If other axes have a direction, an axis
// without one is not in space. If there are more than three axes and some have a spacing, an axis
// without one is not in space either.
AxisRole role_of_domain(const NrrdAxis& axis, const std::vector<NrrdAxis>& axes) {
  const auto has_direction = [](const NrrdAxis& other) { return !other.direction.empty(); };
  const auto has_spacing = [](const NrrdAxis& other) { return !std::isnan(other.spacing); };
  const bool is_out_of_space = std::ranges::any_of(axes, has_direction) && !has_direction(axis);
  const bool is_without_spacing = axes.size() > 3 && std::ranges::any_of(axes, has_spacing) &&
                                  !has_spacing(axis) && axis.kind.empty();
  if (is_out_of_space || is_without_spacing) {
    return axis.size == 1 ? AxisRole::nothing : AxisRole::channel;
  }
  const std::vector<double>& step = axis.direction;
  return step.size() == 4 && step[0] == 0 && step[1] == 0 && step[2] == 0 ? AxisRole::time
                                                                          : AxisRole::space;
}

AxisRole role_of(const NrrdAxis& axis, const std::vector<NrrdAxis>& axes) {
  if (is_domain(axis)) return role_of_domain(axis, axes);
  if (axis.kind == "time") return AxisRole::time;
  if (axis.kind == "list") return AxisRole::layer;
  if ((axis.kind == "stub" || axis.kind == "scalar") && axis.size == 1) return AxisRole::nothing;
  return AxisRole::channel;
}

std::vector<AxisRole> roles_of(const std::vector<NrrdAxis>& axes) {
  std::vector<AxisRole> roles;
  for (const NrrdAxis& axis : axes) {
    roles.push_back(role_of(axis, axes));
  }
  // Drops surplus axes of one sample: 24 x 20 x 16 x 1 is a volume.
  for (std::size_t i = axes.size(); i-- > 0 && std::ranges::count(roles, AxisRole::space) > 3;) {
    if (roles[i] == AxisRole::space && axes[i].size == 1) {
      roles[i] = AxisRole::nothing;
    }
  }
  return roles;
}

std::string shape_of(const std::vector<NrrdAxis>& axes) {
  std::string shape;
  for (const NrrdAxis& axis : axes) {
    shape += (shape.empty() ? "" : " x ") + std::to_string(axis.size);
  }
  return shape;
}

/// The three axes of the volume. Missing axes get one sample, which checked_sample_bytes() refuses.
std::array<NrrdAxis, 3> space_axes(const fs::path& path, const std::vector<NrrdAxis>& axes,
                                   const std::vector<AxisRole>& roles) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::array<NrrdAxis, 3> found;
  found.fill({1, "", "", kNone, kNone, kNone, "", {}});
  std::size_t count = 0;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (roles[i] != AxisRole::space) {
      continue;
    }
    if (count == 3) {
      throw unsupported(
          path,
          "has " + std::to_string(axes.size()) + " dimensions (" + shape_of(axes) +
              ") without stating which of them are not space, expected 3, or the field 'kinds'");
    }
    found[count++] = axes[i];
  }
  return found;
}

/// The names of the values of a sample; numbers if the kind does not name them.
FileChoice named_channels(const fs::path& path, const NrrdAxis& axis) {
  static const std::map<std::string_view, std::vector<std::string>> kNames{
      {"rgb-color", {"red", "green", "blue"}},
      {"rgbcolor", {"red", "green", "blue"}},
      {"rgb", {"red", "green", "blue"}},
      {"rgba-color", {"red", "green", "blue", "alpha"}},
      {"rgbacolor", {"red", "green", "blue", "alpha"}},
      {"rgba", {"red", "green", "blue", "alpha"}},
      {"complex", {"real", "imaginary"}}};
  FileChoice choice = checked_choice(path, "channel", axis.size);
  if (const auto names = kNames.find(axis.kind);
      names != kNames.end() && names->second.size() == axis.size) {
    choice.entries = names->second;
  }
  return choice;
}

struct Segment {
  std::string name;
  std::size_t layer = 0;
  std::int64_t label = 1;
};

/// The segments that 3D Slicer names in a segmentation. Its older files have one layer for each
/// segment.
std::vector<Segment> segments_of(const NrrdHeader& header) {
  std::vector<Segment> segments;
  const auto value_of = [&](const std::string& key) {
    const auto found =
        header.key_values.find("Segment" + std::to_string(segments.size()) + "_" + key);
    return found == header.key_values.end() ? std::optional<std::string>()
                                            : std::optional(found->second);
  };
  while (value_of("ID") || value_of("Name")) {
    const auto layer = integer_of(trimmed(value_of("Layer").value_or("")));
    segments.push_back({one_line(value_of("Name").value_or(value_of("ID").value_or("")), 80),
                        layer ? static_cast<std::size_t>(*layer) : segments.size(),
                        integer_of(trimmed(value_of("LabelValue").value_or("1"))).value_or(1)});
  }
  return segments;
}

/// The name of a layer: the names of its segments, e.g. "liver, spleen".
FileChoice named_layers(const fs::path& path, const std::vector<Segment>& segments,
                        std::size_t count) {
  FileChoice choice = checked_choice(path, "layer", count);
  std::vector<std::string> names(count);
  for (const Segment& segment : segments) {
    if (segment.layer < count) {
      names[segment.layer] += (names[segment.layer].empty() ? "" : ", ") + segment.name;
    }
  }
  for (std::size_t layer = 0; layer < count; ++layer) {
    choice.entries[layer] = names[layer].empty() ? choice.entries[layer] : names[layer];
  }
  return choice;
}

/// Adds the segments and their sample values to the decisions; several segments may share a layer.
void note_segments(const NrrdHeader& header, std::size_t layer, VolumeSource& source) {
  std::string labels;
  for (const Segment& segment : segments_of(header)) {
    if (segment.layer == layer) {
      labels += (labels.empty() ? "" : ", ") + std::to_string(segment.label) + " " + segment.name;
    }
  }
  if (!labels.empty()) {
    source.decisions.push_back({"segments", labels});
  }
}

/// Selects an entry of each list. @returns the index along each axis that is not an axis of the
/// volume
std::vector<StoredAxis> select(const fs::path& path, const NrrdHeader& header,
                               const std::vector<NrrdAxis>& axes,
                               const std::vector<AxisRole>& roles, const ReadOptions& options,
                               VolumeSource& source) {
  std::vector<StoredAxis> stored;
  std::size_t layer = 0;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    StoredAxis& axis = stored.emplace_back(StoredAxis{axes[i].size, {}});
    if (roles[i] != AxisRole::space && roles[i] != AxisRole::nothing &&
        std::ranges::count(roles, roles[i]) > 1) {
      throw unsupported(path, "has " + std::to_string(axes.size()) + " dimensions (" +
                                  shape_of(axes) +
                                  "), several of them lists of one kind, expected one");
    }
    switch (roles[i]) {
      case AxisRole::space:
        break;
      case AxisRole::time:
        axis.selected =
            take_choice(path, source, checked_choice(path, "time", axes[i].size), options.time);
        break;
      case AxisRole::layer:
        layer = take_choice(path, source, named_layers(path, segments_of(header), axes[i].size),
                            options.layer);
        axis.selected = layer;
        break;
      case AxisRole::channel:
        axis.selected = take_choice(path, source, named_channels(path, axes[i]), options.channel);
        break;
      case AxisRole::nothing:
        axis.selected = 0;
        break;
    }
  }
  note_segments(header, layer, source);
  return stored;
}

}  // namespace

VolumeFile read_nrrd(const fs::path& path, const ReadOptions& options) {
  VolumeFile file;
  file.source.format = "NRRD";
  const NrrdHeader header = read_nrrd_header(path);
  if (!header.unknown_fields.empty()) {
    file.source.warnings.push_back("has a header field that NRRD does not know: " +
                                   header.unknown_fields.front());
  }
  file.volume.view.type = nrrd_sample_type(header, path);
  const std::vector<NrrdAxis> axes = nrrd_axes(header, path);
  const std::vector<AxisRole> roles = roles_of(axes);
  const std::array<NrrdAxis, 3> volume_axes = space_axes(path, axes, roles);
  checked_sample_bytes(path, {volume_axes[0].size, volume_axes[1].size, volume_axes[2].size},
                       bytes_per_sample(file.volume.view.type));
  file.volume.view.grid = nrrd_grid(path, volume_axes, nrrd_space(header, path), file.source);
  StoredSamples stored;
  stored.axes = select(path, header, axes, roles, options, file.source);
  find_nrrd_samples(stored, header, path, file.source);
  const std::shared_ptr<std::byte[]> samples =
      read_stored_samples(path, stored, options, file.source);
  file.volume.view.samples = samples.get();
  file.volume.owner = samples;
  return file;
}

}  // namespace isoatlas::detail::io
