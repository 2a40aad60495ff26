// SPDX-License-Identifier: Apache-2.0
#include "volume_files/dicom_volumes.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "files/number_text.h"

namespace isoatlas::detail::io {

namespace {

// The largest offset of a slice from its regular position, as a fraction of the slice distance:
// positions are written with few digits. A missing slice causes an offset of 1.
constexpr double kPositionTolerance = 0.1;
constexpr double kGapTolerance = 0.5;
constexpr double kSameDirectionTolerance = 1e-3;
// Slices whose distance is below this fraction of a pixel have the same position.
constexpr double kSamePositionTolerance = 1e-2;

Vec3 difference(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
double length(const Vec3& v) { return std::hypot(v.x, v.y, v.z); }
double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Vec3 unit(const Vec3& v) {
  const double size = length(v);
  return {v.x / size, v.y / size, v.z / size};
}

bool have_same_position(const DicomFrame& a, const DicomFrame& b) {
  return length(difference(a.position, b.position)) <=
         kSamePositionTolerance * std::min(a.spacing_x, a.spacing_y);
}

// Orders numbers by value and texts by alphabet, numbers first: "2" precedes "10".
bool comes_before(const std::string& a, const std::string& b) {
  const auto number = [](const std::string& text) -> std::optional<double> {
    double value = 0;
    return parse_number(text, value) ? std::optional(value) : std::nullopt;
  };
  const std::optional<double> first = number(a), second = number(b);
  if (first.has_value() != second.has_value()) {
    return first.has_value();
  }
  return first && *first != *second ? *first < *second : a < b;
}

struct Before {
  bool operator()(const std::string& a, const std::string& b) const { return comes_before(a, b); }
};

std::string length_text(double value) { return dicom_number(std::round(value * 1e6) / 1e6); }

// Describes the first gap that differs from the median gap by more than kGapTolerance: a slice may
// be missing. Empty if all gaps are even.
std::string uneven_gap(const std::vector<DicomFrame>& frames) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    gaps.push_back(length(difference(frames[i].position, frames[i - 1].position)));
  }
  std::vector<double> sorted = gaps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double usual = *middle;
  const auto is_uneven = [usual](double gap) {
    return std::abs(gap - usual) > kGapTolerance * usual;
  };
  const auto found = std::ranges::find_if(gaps, is_uneven);
  if (found == gaps.end()) {
    return {};
  }
  const auto i = static_cast<std::size_t>(found - gaps.begin());
  return "slices are not evenly spaced: " + length_text(*found) + " from " + frames[i].name() +
         " to " + frames[i + 1].name() + ", usually " + length_text(usual) +
         "; check whether a slice is missing";
}

// Describes the slice with the largest offset from its position in an evenly spaced stack, if it is
// too large: small differences between gaps can add up.
std::string misplaced_slice(const std::vector<DicomFrame>& frames, const Vec3& step) {
  std::size_t worst = 0;
  Vec3 offset;  // of the worst slice, from its position in an even stack
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto steps = static_cast<double>(i);
    const Vec3 expected{step.x * steps, step.y * steps, step.z * steps};
    const Vec3 found =
        difference(difference(frames[i].position, frames.front().position), expected);
    if (length(found) > length(offset)) {
      worst = i;
      offset = found;
    }
  }
  if (length(offset) <= kPositionTolerance * length(step)) {
    return {};
  }
  const double along = std::abs(dot(offset, unit(step)));
  const double beside = std::sqrt(std::max(0.0, dot(offset, offset) - along * along));
  const std::string name = frames[worst].name(), apart = length_text(length(step)) + " apart";
  return along >= beside
             ? "slices are not evenly spaced: " + name + " is " + length_text(along) +
                   " from its position in an even stack of slices " + apart
             : "slices are not in line: " + name + " lies " + length_text(beside) +
                   " from the line through the first and the last slice, of slices " + apart;
}

/// The volumes that result from splitting frames by an attribute.
struct Split {
  std::vector<std::string> names;
  std::vector<DicomStack> volumes;
};

const DicomLabel* label_named(const DicomFrame& frame, const std::string& name) {
  const auto found = std::ranges::find(*frame.labels, name, &DicomLabel::name);
  return found == frame.labels->end() ? nullptr : &*found;
}

// Groups frames by their values of these labels; empty if all frames have the same values.
std::map<std::string, std::vector<DicomFrame>, Before> parts_by(
    const std::vector<DicomFrame>& frames, const std::vector<std::string>& names) {
  std::map<std::string, std::vector<DicomFrame>, Before> parts;
  for (const DicomFrame& frame : frames) {
    std::string value;
    for (const std::string& name : names) {
      const DicomLabel* label = label_named(frame, name);
      value +=
          (value.empty() ? "" : ", " + name + " ") + (label == nullptr ? "none" : label->value);
    }
    parts[value].push_back(frame);
  }
  if (parts.size() < 2) {
    parts.clear();
  }
  return parts;
}

// True if two volumes have nearly the same position. A volume may move a little between two times,
// with the patient or by the scanner's motion correction.
bool have_similar_positions(const DicomStack& a, const DicomStack& b) {
  constexpr double kNear = 0.75;  // times the slice distance
  const auto are_near = [&](const DicomFrame& slice, const DicomFrame& other) {
    return have_same_position(slice, other) ||
           length(difference(slice.position, other.position)) <= kNear * length(a.step);
  };
  return std::ranges::equal(a.frames, b.frames, are_near);
}

Split stacks_of(const std::map<std::string, std::vector<DicomFrame>, Before>& parts,
                const std::string& name) {
  Split split;
  for (const auto& [value, frames] : parts) {
    split.names.push_back(name + " " + value);
    split.volumes.push_back(stack_of(frames));
  }
  return split;
}

// True if all volumes have the same positions, apart from small movements, and one slice at each
// position.
bool is_split_in_time(const Split& split) {
  return split.volumes.size() > 1 &&
         std::ranges::all_of(split.volumes, [&](const DicomStack& volume) {
           return volume.frames.size() > 1 && volume.problem.empty() &&
                  have_similar_positions(volume, split.volumes.front());
         });
}

// True if the volumes are independent; remaining single slices become entries of their own.
bool is_split_in_space(const Split& split) {
  return std::ranges::any_of(split.volumes,
                             [](const DicomStack& volume) { return volume.frames.size() > 1; }) &&
         std::ranges::all_of(split.volumes,
                             [](const DicomStack& volume) { return volume.problem.empty(); });
}

using Kind = DicomLabel::Kind;

std::vector<std::string> label_names(const std::vector<DicomFrame>& frames,
                                     std::initializer_list<Kind> kinds) {
  std::vector<std::string> names;
  for (const DicomFrame& frame : frames) {
    for (const DicomLabel& label : *frame.labels) {
      if (std::ranges::find(kinds, label.kind) != kinds.end() &&
          std::ranges::find(names, label.name) == names.end()) {
        names.push_back(label.name);
      }
    }
  }
  return names;
}

std::optional<Split> split_in_time(const std::vector<DicomFrame>& frames,
                                   std::initializer_list<Kind> kinds) {
  const std::vector<std::string> names = label_names(frames, kinds);
  for (const std::string& name : names) {
    Split split = stacks_of(parts_by(frames, {name}), name);
    if (is_split_in_time(split)) {
      return split;
    }
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t k = i + 1; k < names.size(); ++k) {
      Split split = stacks_of(parts_by(frames, {names[i], names[k]}), names[i]);
      if (is_split_in_time(split)) {
        return split;
      }
    }
  }
  return std::nullopt;
}

std::optional<Split> split_in_space(const std::vector<DicomFrame>& frames,
                                    std::initializer_list<Kind> kinds) {
  for (const std::string& name : label_names(frames, kinds)) {
    Split split = stacks_of(parts_by(frames, {name}), name);
    if (split.volumes.size() > 1 && is_split_in_space(split)) {
      return split;
    }
  }
  return std::nullopt;
}

// Splits frames by their order: no attribute distinguishes the volumes, but they follow each other
// in the order in which frames are numbered.
std::optional<Split> split_by_runs(std::vector<DicomFrame> frames, std::size_t positions) {
  const auto number = [](const DicomFrame& frame) {
    return std::pair(frame.image->instance_number, frame.number);
  };
  std::ranges::sort(frames, {}, number);
  const bool is_one_file = std::ranges::all_of(
      frames, [&](const DicomFrame& frame) { return frame.image == frames.front().image; });
  if (positions == 0 || frames.size() % positions != 0 ||
      std::ranges::adjacent_find(frames, {}, number) != frames.end()) {
    return std::nullopt;
  }
  Split split;
  for (std::size_t first = 0; first < frames.size(); first += positions) {
    const auto begin = frames.begin() + static_cast<std::ptrdiff_t>(first),
               end = begin + static_cast<std::ptrdiff_t>(positions);
    const auto shown = [&](const DicomFrame& frame) {
      return is_one_file ? std::to_string(frame.number + 1)
                         : std::to_string(frame.image->instance_number);
    };
    split.names.push_back((is_one_file ? "frames " : "images ") + shown(*begin) + " to " +
                          shown(*(end - 1)));
    split.volumes.push_back(stack_of({begin, end}));
  }
  return is_split_in_time(split) ? std::optional(split) : std::nullopt;
}

std::size_t count_positions(const DicomStack& sorted) {
  std::size_t positions = 1;
  for (std::size_t i = 1; i < sorted.frames.size(); ++i) {
    positions += have_same_position(sorted.frames[i], sorted.frames[i - 1]) ? 0 : 1;
  }
  return positions;
}

/// Frames whose image planes allow them to be one volume.
struct PlaneGroup {
  std::vector<DicomFrame> frames;
  bool ignores_world = false;

  bool takes(const DicomFrame& frame) const {
    const DicomFrame& own = frames.front();
    return frame.image->series == own.image->series &&
           (ignores_world || frame.image->world == own.image->world) &&
           frame.image->rows == own.image->rows && frame.image->columns == own.image->columns &&
           frame.stack == own.stack &&
           length(difference(unit(frame.along_row), unit(own.along_row))) <=
               kSameDirectionTolerance &&
           length(difference(unit(frame.along_column), unit(own.along_column))) <=
               kSameDirectionTolerance;
  }
};

std::vector<PlaneGroup> group_by_plane(std::vector<DicomFrame> frames) {
  // Anonymized files may have a different frame of reference for each slice.
  std::set<std::pair<std::string, std::string>> worlds;
  std::set<const DicomImage*> images;
  for (const DicomFrame& frame : frames) {
    worlds.insert({frame.image->series, frame.image->world});
    images.insert(frame.image.get());
  }
  const bool ignores_world = worlds.size() == images.size();
  std::vector<PlaneGroup> groups;
  std::size_t last = 0;  // mostly, a frame is in the same group as its predecessor
  for (DicomFrame& frame : frames) {
    if (last >= groups.size() || !groups[last].takes(frame)) {
      const auto found =
          std::ranges::find_if(groups, [&](const PlaneGroup& group) { return group.takes(frame); });
      last = static_cast<std::size_t>(found - groups.begin());
      if (found == groups.end()) {
        groups.push_back({{}, ignores_world});
      }
    }
    groups[last].frames.push_back(std::move(frame));
  }
  return groups;
}

// Adds one series, or several if an attribute distinguishes its frames. If all frames together are
// an even stack, only an attribute that never varies within a volume can split them.
void add_series(std::vector<DicomFrame> frames, std::vector<DicomSeries>& all) {
  DicomStack whole = stack_of(std::move(frames));
  const bool is_even = whole.problem.empty();
  std::optional<Split> in_time = is_even ? split_in_time(whole.frames, {Kind::volume})
                                         : split_in_time(whole.frames, {Kind::volume, Kind::time});
  std::optional<Split> in_space;
  if (!in_time) {
    in_space = is_even ? split_in_space(whole.frames, {Kind::volume})
                       : split_in_space(whole.frames, {Kind::other});
  }
  if (is_even && in_space && std::ranges::any_of(in_space->volumes, [](const DicomStack& v) {
        return v.frames.size() < 2;
      })) {
    in_space.reset();
  }
  if (whole.has_equal_positions && !in_time && !in_space) {
    in_time = split_by_runs(whole.frames, count_positions(whole));
  }
  if (in_time) {
    all.push_back({{}, std::move(in_time->volumes), std::move(in_time->names)});
  } else if (in_space) {
    for (std::size_t i = 0; i < in_space->volumes.size(); ++i) {
      all.push_back({in_space->names[i], {std::move(in_space->volumes[i])}, {}});
    }
  } else {
    all.push_back({{}, {std::move(whole)}, {}});
  }
}

// Names the parts of a series whose entries differ in their planes.
void name_parts(std::vector<DicomSeries>& all) {
  for (DicomSeries& one : all) {
    const auto is_same = [&](const DicomSeries& other) {
      return &other != &one && other.image().series == one.image().series;
    };
    if (one.part.empty() && std::ranges::any_of(all, is_same)) {
      const Vec3 normal =
          unit(cross(one.volumes[0].frames[0].along_row, one.volumes[0].frames[0].along_column));
      const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
      one.part = z >= x && z >= y ? "axial" : y >= x ? "coronal" : "sagittal";
      const std::string& stack = one.volumes[0].frames[0].stack;
      const auto is_of_other_world = [&](const DicomSeries& other) {
        return is_same(other) && other.image().world != one.image().world;
      };
      if (std::ranges::any_of(all, is_of_other_world)) {
        one.part += ", frame of reference " +
                    dicom_text(one.image().world.substr(one.image().world.rfind('\n') + 1));
      }
      one.part = stack.empty() ? one.part : "stack " + dicom_text(stack) + ", " + one.part;
    }
  }
}

}  // namespace

DicomStack stack_of(std::vector<DicomFrame> frames) {
  DicomStack stack{std::move(frames), {}, {}, false};
  std::vector<DicomFrame>& sorted = stack.frames;
  const Vec3 normal = cross(sorted.front().along_row, sorted.front().along_column);
  std::ranges::stable_sort(sorted, {},
                           [&](const DicomFrame& frame) { return dot(normal, frame.position); });
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (have_same_position(sorted[i - 1], sorted[i])) {
      stack.problem = "has two slices at one position: " + sorted[i - 1].name() + ", " +
                      sorted[i].name() +
                      "; expected one slice at each position; the series may have several volumes";
      stack.has_equal_positions = true;
      return stack;
    }
  }
  if (sorted.size() > 1) {
    const auto count = static_cast<double>(sorted.size() - 1);
    const Vec3 whole = difference(sorted.back().position, sorted.front().position);
    stack.step = {whole.x / count, whole.y / count, whole.z / count};
    stack.problem = uneven_gap(sorted);
    if (stack.problem.empty()) {
      stack.problem = misplaced_slice(sorted, stack.step);
    }
  }
  return stack;
}

std::string DicomSeries::description() const {
  const DicomImage& first = image();
  const std::size_t slices = volumes.front().frames.size();
  std::string text = first.series_number.empty() ? "" : "series " + first.series_number;
  const auto add = [&](const std::string& more, const std::string& separator) {
    if (!more.empty()) {
      text += (text.empty() ? "" : separator) + more;
    }
  };
  add(first.description, " ");
  add(part, ", ");
  add(first.modality, ", ");
  add((volumes.size() > 1 ? std::to_string(volumes.size()) + " x " : "") + std::to_string(slices) +
          (slices == 1 ? " slice" : " slices") + " of " + std::to_string(first.columns) + " x " +
          std::to_string(first.rows),
      ", ");
  add("UID " + first.series, ", ");
  return text;
}

std::vector<DicomSeries> series_of(std::vector<DicomFrame> frames) {
  // If a writer gives every frame a stack of its own, the stacks have no meaning.
  std::set<std::string> stacks;
  for (const DicomFrame& frame : frames) {
    stacks.insert(frame.stack);
  }
  if (stacks.size() == frames.size()) {
    for (DicomFrame& frame : frames) {
      frame.stack.clear();
    }
  }
  std::vector<DicomSeries> all;
  for (PlaneGroup& group : group_by_plane(std::move(frames))) {
    add_series(std::move(group.frames), all);
  }
  std::ranges::stable_sort(all, [](const DicomSeries& a, const DicomSeries& b) {
    const DicomImage &first = a.image(), &second = b.image();
    return first.series_number != second.series_number
               ? comes_before(first.series_number, second.series_number)
               : first.series < second.series;
  });
  name_parts(all);
  return all;
}

}  // namespace isoatlas::detail::io
