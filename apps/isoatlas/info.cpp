// SPDX-License-Identifier: Apache-2.0
// isoatlas info: describes a volume and suggests isovalues.
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>
#include <optional>
#include <string>

#include "commands.h"
#include "exit_status.h"
#include "isoatlas/volume_file.h"
#include "report/report.h"
#include "sample_histogram.h"
#include "text.h"
#include "volume_input.h"

namespace isoatlas::detail::tool {
namespace {

/// The vector as text. Components that are rounding errors relative to `scale` become 0.
std::string vector_text(Vec3 v, double scale) {
  const auto tidy = [scale](double x) { return std::abs(x) < 1e-9 * scale ? 0.0 : x; };
  return number_text(tidy(v.x)) + " " + number_text(tidy(v.y)) + " " + number_text(tidy(v.z));
}

double component(Vec3 v, std::size_t i) { return i == 0 ? v.x : i == 1 ? v.y : v.z; }

/// The main direction of each axis in a world whose x, y and z point to left, posterior and
/// superior.
struct Orientation {
  std::array<const char*, 3> towards{};
  double tilt_degrees = 0;  ///< largest angle between an axis and the world axis it is named after
};

Orientation orientation(const Grid& grid) {
  static constexpr const char* kPositive[] = {"Left", "Posterior", "Superior"};
  static constexpr const char* kNegative[] = {"Right", "Anterior", "Inferior"};
  // Each axis gets its own world axis, so that no letter occurs twice even on an oblique grid: the
  // best of the six assignments.
  std::array<std::size_t, 3> order{0, 1, 2}, best_order = order;
  double best = -1;
  do {
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      sum += std::abs(component(grid.direction[axis], order[axis]));
    if (sum > best) best = sum, best_order = order;
  } while (std::next_permutation(order.begin(), order.end()));

  Orientation result;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double along = component(grid.direction[axis], best_order[axis]);
    result.towards[axis] = (along >= 0 ? kPositive : kNegative)[best_order[axis]];
    const double angle = std::acos(std::min(1.0, std::abs(along))) * 180 / std::numbers::pi;
    result.tilt_degrees = std::max(result.tilt_degrees, angle);
  }
  return result;
}

std::string orientation_text(const Grid& grid) {
  const Orientation found = orientation(grid);
  std::string code, words;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    code += found.towards[axis][0];
    words += std::string(axis == 0 ? "" : ", ") + "xyz"[axis] + " towards " + found.towards[axis];
  }
  const bool oblique = found.tilt_degrees > 0.05;
  return code + " (" + words + ")" +
         (oblique
              ? ", oblique by " + number_text(std::round(found.tilt_degrees * 10) / 10) + " degrees"
              : "");
}

/// " mm"; empty if the volume states no unit.
std::string unit_text(const Grid& grid) {
  return grid.unit == LengthUnit::unknown ? "" : " " + std::string(symbol(grid.unit));
}

void print_source(const VolumeSource& source) {
  std::cout << row("format",
                   source.format + (source.reader.empty() ? "" : ", read by " + source.reader));
  for (std::size_t i = 0; i < source.decisions.size(); ++i)
    std::cout << row(i == 0 ? "read as" : "",
                     source.decisions[i].key + ": " + one_line(source.decisions[i].value));
  for (const FileChoice& choice : source.choices) {
    if (choice.selected && choice.entries.size() == 1) continue;
    std::cout << row(choice.name, one_line(choice_text(choice)));
    for (std::size_t i = 0; i < choice.entries.size(); ++i) {
      const std::string number = std::to_string(i);
      std::cout << row(
          "", number + (choice.entries[i] == number ? "" : "  " + one_line(choice.entries[i])));
    }
  }
}

void print_geometry(const VolumeView& volume) {
  const Grid& grid = volume.grid;
  const auto extent = [&](std::size_t axis) {
    return number_text(static_cast<double>(grid.size[axis] - 1) * component(grid.spacing, axis));
  };
  const std::size_t bytes = grid.sample_count() * bytes_per_sample(volume.type);
  std::cout << row("size", size_text(grid.size) + ", " + counted(grid.sample_count(), "sample"))
            << row("type", std::string(name(volume.type)) + ", " +
                               bytes_text(static_cast<double>(bytes)) + " in memory")
            << row("spacing", vector_text(grid.spacing, 0) + unit_text(grid))
            << row("extent", extent(0) + " x " + extent(1) + " x " + extent(2) + unit_text(grid) +
                                 ", first to last sample")
            << row("origin", vector_text(grid.origin, grid.smallest_spacing()))
            << row("orientation", orientation_text(grid));
  for (std::size_t r = 0; r < 3; ++r)
    std::cout << row(r == 0 ? "direction" : "",
                     vector_text({component(grid.direction[0], r), component(grid.direction[1], r),
                                  component(grid.direction[2], r)},
                                 1));
}

void print_histogram(const SampleHistogram& histogram, const SampleSummary& summary, bool utf8) {
  constexpr std::size_t kColumns = 64;
  constexpr int kRows = 6, kWidestColumn = 8;
  const SampleHistogram drawn = coarsened(histogram, kColumns);
  const int column_width =
      std::clamp(static_cast<int>(kColumns / drawn.counts.size()), 1, kWidestColumn);
  std::string label = "histogram";
  for (const std::string& line :
       draw_histogram(drawn.counts, kRows, column_width, Scale::logarithmic, utf8)) {
    std::cout << row(label, line);
    label.clear();
  }
  const std::size_t width = drawn.counts.size() * static_cast<std::size_t>(column_width);
  const std::string low = number_text(summary.minimum), high = number_text(summary.maximum);
  const std::size_t gap = low.size() + high.size() < width ? width - low.size() - high.size() : 2;
  std::cout << row("", low + std::string(gap, ' ') + high);
}

void print_suggestions(const std::vector<SuggestedIsovalue>& suggestions,
                       const SampleHistogram& histogram) {
  if (suggestions.empty()) {
    std::cout << row("isovalues", "none: all samples are equal");
    return;
  }
  std::string label = "isovalues";
  for (const SuggestedIsovalue& suggestion : suggestions) {
    std::string value = number_text(suggestion.value);
    value.resize(std::max<std::size_t>(value.size(), 8), ' ');
    std::cout << row(label, value + "  " + suggestion.reason);
    label.clear();
  }
  if (histogram.of_integers)
    std::cout << row("", "half-way between integers, so that no sample equals the isovalue");
}

}  // namespace

namespace {

/// @param volume  null if the user has to choose a volume first
InfoReport info_report(const std::string& path, const VolumeSource& source, const Volume* volume,
                       const SampleHistogram* histogram,
                       const std::optional<SampleSummary>& summary) {
  InfoReport info;
  info.volume.path = path;
  info.volume.source = source;
  info.samples = summary;
  if (volume == nullptr) return info;
  info.volume.grid = volume->view.grid;
  info.volume.sample_type = volume->view.type;
  info.volume.sample_digest = sample_digest(*volume);
  if (histogram == nullptr) return info;
  for (const SuggestedIsovalue& isovalue : suggest_isovalues(*histogram, *summary))
    info.isovalues.push_back({isovalue.value, isovalue.reason});
  return info;
}

void print_samples(const SampleSummary& summary) {
  const auto& first = summary.first_non_finite;
  std::string not_finite =
      count_text(summary.nan_count) + " NaN, " + count_text(summary.infinity_count) + " infinite";
  if (summary.nan_count + summary.infinity_count > 0)
    not_finite += ", first at (" + std::to_string(first[0]) + ", " + std::to_string(first[1]) +
                  ", " + std::to_string(first[2]) + "); isoatlas extract needs --nan";
  if (summary.finite_count > 0)
    std::cout << row("range", number_text(summary.minimum) + " to " + number_text(summary.maximum));
  std::cout << row("not finite", not_finite);
}

/// Lists the volumes in a file that holds several.
int list_choices(const InfoArguments& arguments, const ChoiceNeeded& needed) {
  if (arguments.json) {
    std::cout << to_json(info_report(arguments.volume.path.string(), needed.source(), nullptr,
                                     nullptr, std::nullopt));
  } else {
    std::cout << one_line(volume_name(arguments.volume.path)) << "\n";
    print_source(needed.source());
  }
  return kSuccess;
}

int describe(const InfoArguments& arguments, const VolumeFile& file) {
  const SampleSummary summary = summarize(file.volume);
  std::optional<SampleHistogram> histogram;
  if (summary.finite_count > 0) histogram = sample_histogram(file.volume, summary);
  const InfoReport info = info_report(arguments.volume.path.string(), file.source, &file.volume,
                                      histogram ? &*histogram : nullptr, summary);
  if (arguments.json) {
    std::cout << to_json(info);
    return kSuccess;
  }
  std::cout << one_line(volume_name(arguments.volume.path)) << "\n";
  print_source(file.source);
  print_geometry(file.volume);
  print_samples(summary);
  if (histogram) {
    print_histogram(*histogram, summary, terminal_is_utf8());
    print_suggestions(suggest_isovalues(*histogram, summary), *histogram);
  }
  std::cout << row("sha256", info.volume.sample_digest);
  return kSuccess;
}

}  // namespace

int run_info(const InfoArguments& arguments) {
  std::optional<VolumeFile> file;
  try {
    file = read_volume_input(arguments.volume.path, arguments.volume.read);
  } catch (const ChoiceNeeded& needed) {
    return list_choices(arguments, needed);
  }
  print_warnings(std::cerr, arguments.volume.path, file->source);
  return describe(arguments, *file);
}

}  // namespace isoatlas::detail::tool
