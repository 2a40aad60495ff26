// SPDX-License-Identifier: Apache-2.0
#include "wording/settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>
#include <utility>

#include "isoatlas/error.h"
#include "wording/choices.h"

namespace isoatlas::detail {
namespace {

[[noreturn]] void refuse_name(std::string_view name) {
  throw Error(ErrorCode::bad_argument, "there is no option '" + std::string(name) + "'");
}

std::size_t parse_samples(std::string_view text) {
  const auto number = parse_whole<std::uint32_t>(text);
  if (!number || *number == 0) refuse_value("a whole number, 1 or more", text);
  return *number;
}

}  // namespace

Vec3 parse_point(std::string_view text) {
  const auto [x, y, z] = parse_triple<double>(text, "three numbers like 12.5,-3,40",
                                              [](double v) { return std::isfinite(v); });
  return {x, y, z};
}

TypedLength parse_length(std::string_view text) {
  const auto length = length_of(text);
  if (!length) refuse_fraction("a length like 3vx, 2.5mm or 2.5", text);
  return *length;
}

int parse_threads(std::string_view text) {
  const auto number = parse_whole<int>(text);
  if (!number || *number < 0) refuse_value("a whole number, 0 or more", text);
  return *number;
}

std::pair<std::array<double, 3>, LengthUnit> parse_spacing(std::string_view text) {
  constexpr const char* kExpected =
      "three positive numbers like 1,1,2.5, or with one unit at the end like 0.2,0.2,1um";
  const std::size_t unit_begin = std::min(text.find_last_of("0123456789."), text.size() - 1) + 1;
  std::string_view unit_text = text.substr(std::min(unit_begin, text.size()));
  while (unit_text.starts_with(' ')) unit_text.remove_prefix(1);
  const LengthUnit unit = length_unit_named(unit_text);
  if (!unit_text.empty() && unit == LengthUnit::unknown) refuse_value(kExpected, text);
  const auto accept = [](double s) { return std::isfinite(s) && s > 0; };
  try {
    return {parse_triple<double>(text.substr(0, unit_begin), kExpected, accept), unit};
  } catch (const Error&) {
    refuse_value(kExpected, text);  // the whole text, with the unit
  }
}

std::uint64_t parse_bytes(std::string_view text) {
  std::string_view number = text;
  double factor = 1;
  constexpr std::array<std::pair<std::string_view, double>, 9> kUnits{{{"GiB", 0x1p30},
                                                                       {"MiB", 0x1p20},
                                                                       {"KiB", 0x1p10},
                                                                       {"GB", 1e9},
                                                                       {"MB", 1e6},
                                                                       {"kB", 1e3},
                                                                       {"G", 0x1p30},
                                                                       {"M", 0x1p20},
                                                                       {"K", 0x1p10}}};
  for (const auto& [unit, bytes] : kUnits) {
    if (number.ends_with(unit)) {
      number.remove_suffix(unit.size());
      factor = bytes;
      break;
    }
  }
  while (number.ends_with(' ')) number.remove_suffix(1);
  const auto value = parse_whole<double>(number);
  if (!value || !(*value * factor >= 1) || *value * factor > 0x1p62)
    refuse_value("a size like 8GiB or 500MB", text);
  return static_cast<std::uint64_t>(*value * factor);
}

void set(ExtractSettings& settings, std::string_view name, std::string_view text) {
  ExtractOptions& options = settings.options;
  if (name == "iso") {
    options.surface.isovalue = parse_finite(text);
  } else if (name == "nan") {
    options.surface.non_finite = parse_non_finite(text);
  } else if (name == "inside") {
    options.surface.inside = parse_inside(text);
  } else if (name == "topology") {
    options.surface.topology = parse_topology(text);
  } else if (name == "interpolation") {
    options.surface.interpolation = parse_interpolation(text);
  } else if (name == "supersample") {
    const auto factor = parse_whole<std::uint32_t>(text);
    if (!factor || *factor == 0) refuse_value("a whole number, 1 or more", text);
    options.supersample = *factor;
  } else if (name == "adaptive-supersample") {
    const auto times = parse_whole<std::uint32_t>(text);
    if (!times || *times > kMaxSubdivisions) refuse_value("a whole number from 0 to 8", text);
    options.adaptive_supersample = *times;
  } else if (name == "levels") {
    const auto count = parse_whole<std::uint32_t>(text);
    if (!count || *count == 0 || *count > kMaxLevels)
      refuse_value("a whole number from 1 to " + std::to_string(kMaxLevels), text);
    options.levels = *count;
  } else if (name == "min-component-size") {
    settings.min_component_size = space_size_of(text);
    if (!settings.min_component_size) refuse_fraction("a size like 10vx, 2.5mm3 or 2.5", text);
  } else if (name == "keep-components") {
    const auto count = parse_whole<std::size_t>(text);
    if (!count || *count == 0) refuse_value("a whole number, 1 or more", text);
    options.components.keep_largest = *count;
  } else if (name == "keep-near") {
    options.components.keep_near.push_back(parse_point(text));
  } else if (name == "drop-near") {
    options.components.drop_near.push_back(parse_point(text));
  } else if (name == "max-radius") {
    settings.max_radius = parse_length(text);
    if (settings.max_radius->value == 0) refuse_fraction("a length above 0", text);
  } else if (name == "covering") {
    options.covering.strategy = parse_covering(text);
  } else if (name == "event-persistence") {
    settings.event_persistence = parse_length(text);
  } else if (name == "border") {
    options.border = parse_border(text);
  } else if (name == "placement") {
    options.placement = parse_placement(text);
  } else if (name == "space") {
    options.space = parse_space(text);
  } else if (name == "measure-samples") {
    options.measure_samples = parse_samples(text);
  } else if (name == "threads") {
    settings.threads = parse_threads(text);
  } else {
    refuse_name(name);
  }
}

void set(MeasureOptions& options, std::string_view name, std::string_view text) {
  if (name == "iso") {
    options.surface.isovalue = parse_finite(text);
  } else if (name == "inside") {
    options.surface.inside = parse_inside(text);
  } else if (name == "topology") {
    options.surface.topology = parse_topology(text);
  } else if (name == "nan") {
    options.surface.non_finite = parse_non_finite(text);
  } else if (name == "interpolation") {
    options.surface.interpolation = parse_interpolation(text);
  } else if (name == "space") {
    options.space = parse_space(text);
  } else if (name == "samples") {
    options.samples = parse_samples(text);
  } else {
    refuse_name(name);
  }
}

namespace {

bool set_raw(RawLayout& layout, std::string_view name, std::string_view text) {
  if (name == "raw-size") {
    layout.size = parse_triple<std::size_t>(text, "three whole numbers like 256,256,94",
                                            [](std::size_t n) { return n > 0; });
  } else if (name == "raw-type") {
    layout.type = parse_sample_type(text);
  } else if (name == "raw-spacing") {
    std::tie(layout.spacing, layout.unit) = parse_spacing(text);
  } else if (name == "raw-endian") {
    layout.big_endian = parse_is_big_endian(text);
  } else if (name == "raw-offset") {
    const auto bytes = parse_whole<std::uint64_t>(text);
    if (!bytes) refuse_value("a number of bytes, 0 or more", text);
    layout.offset = *bytes;
  } else {
    return false;
  }
  return true;
}

Region parse_region(std::string_view text) {
  constexpr const char* kExpected =
      "three ranges of samples, both ends included, like 10:99,0:63,: where an empty end is the "
      "volume boundary";
  Region region;
  std::string_view rest = text;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t comma = rest.find(',');
    if ((comma == std::string_view::npos) != (a == 2)) refuse_value(kExpected, text);
    const std::string_view range = trimmed(rest.substr(0, comma));
    const std::size_t colon = range.find(':');
    if (colon == std::string_view::npos) refuse_value(kExpected, text);
    const auto end = [&](std::string_view word, std::size_t boundary) {
      word = trimmed(word);
      if (word.empty()) return boundary;
      const auto index = parse_whole<std::uint32_t>(word);
      if (!index) refuse_value(kExpected, text);
      return static_cast<std::size_t>(*index);
    };
    region.first[a] = end(range.substr(0, colon), 0);
    region.last[a] = end(range.substr(colon + 1), Region::kEnd);
    rest.remove_prefix(comma == std::string_view::npos ? rest.size() : comma + 1);
  }
  return region;
}

std::size_t parse_entry(std::string_view text) {
  const auto entry = parse_whole<std::uint32_t>(text);
  if (!entry) refuse_value("a whole number, 0 for the first", text);
  return *entry;
}

}  // namespace

void set(ReadOptions& options, std::string_view name, std::string_view text) {
  if (name.starts_with("raw-")) {
    if (!set_raw(options.raw ? *options.raw : options.raw.emplace(), name, text)) refuse_name(name);
  } else if (name == "channel") {
    options.channel = std::string(trimmed(text));
  } else if (name == "time") {
    options.time = parse_entry(text);
  } else if (name == "layer") {
    options.layer = text;
  } else if (name == "array") {
    options.array = text;
  } else if (name == "series") {
    options.series = text;
  } else if (name == "spacing") {
    const auto [spacing, unit] = parse_spacing(text);
    options.spacing = Vec3{spacing[0], spacing[1], spacing[2]};
    options.spacing_unit = unit;
  } else if (name == "roi") {
    options.region = parse_region(text);
  } else if (name == "max-memory") {
    options.max_memory = parse_bytes(text);
  } else {
    refuse_name(name);
  }
}

namespace {

/// measure.in_world(grid); error messages start with the name of the setting.
template <class Measure>
double named_in_world(std::string_view name, const Measure& measure, const Grid& grid) {
  try {
    return measure.in_world(grid);
  } catch (const Error& error) {
    throw Error(error.code(), std::string(name) + ": " + error.what());
  }
}

}  // namespace

ExtractOptions in_world(const ExtractSettings& settings, const Grid& grid) {
  ExtractOptions options = settings.options;
  if (settings.max_radius)
    options.covering.max_radius = named_in_world("max-radius", *settings.max_radius, grid);
  if (settings.min_component_size)
    options.components.min_size =
        named_in_world("min-component-size", *settings.min_component_size, grid);
  if (settings.event_persistence)
    options.covering.event_persistence =
        named_in_world("event-persistence", *settings.event_persistence, grid);
  options.coarse = in_world(settings.goals.coarse, grid);
  options.refine.clear();
  for (const auto& goal : settings.goals.refine) options.refine.push_back(in_world(goal, grid));
  return options;
}

}  // namespace isoatlas::detail
