// SPDX-License-Identifier: Apache-2.0
#include "wording/settings.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "isoatlas/error.h"
#include "wording/choices.h"

namespace isoatlas {
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

Length parse_length(std::string_view text) {
  const auto length = length_of(text);
  if (!length) refuse_fraction("a length like 2.5, 2.5mm or 3vx", text);
  return *length;
}

int parse_threads(std::string_view text) {
  const auto number = parse_whole<int>(text);
  if (!number || *number < 0) refuse_value("a whole number, 0 or more", text);
  return *number;
}

void set(ExtractSettings& settings, std::string_view name, std::string_view text) {
  ExtractOptions& options = settings.options;
  if (name == "iso") {
    options.isovalue = parse_finite(text);
  } else if (name == "nan") {
    options.non_finite = parse_non_finite(text);
  } else if (name == "inside") {
    options.inside = parse_inside(text);
  } else if (name == "topology") {
    options.topology = parse_topology(text);
  } else if (name == "interpolation") {
    options.interpolation = parse_interpolation(text);
  } else if (name == "supersample") {
    const auto factor = parse_whole<std::uint32_t>(text);
    if (!factor || *factor == 0) refuse_value("a whole number, 1 or more", text);
    options.supersample = *factor;
  } else if (name == "adaptive-supersample") {
    const auto times = parse_whole<std::uint32_t>(text);
    if (!times || *times > kMostDivisions) refuse_value("a whole number from 0 to 8", text);
    options.adaptive_supersample = *times;
  } else if (name == "min-component-size") {
    settings.min_component_size = space_size_of(text);
    if (!settings.min_component_size) refuse_fraction("a size like 10vx or 2.5mm3", text);
  } else if (name == "keep-components") {
    const auto count = parse_whole<std::size_t>(text);
    if (!count || *count == 0) refuse_value("a whole number, 1 or more", text);
    options.keep_components = *count;
  } else if (name == "max-radius") {
    settings.max_radius = parse_length(text);
    if (settings.max_radius->value == 0) refuse_fraction("a length above 0", text);
  } else if (name == "covering") {
    options.covering = parse_covering(text);
  } else if (name == "event-persistence") {
    settings.event_persistence = parse_length(text);
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
    options.isovalue = parse_finite(text);
  } else if (name == "inside") {
    options.inside = parse_inside(text);
  } else if (name == "topology") {
    options.topology = parse_topology(text);
  } else if (name == "nan") {
    options.non_finite = parse_non_finite(text);
  } else if (name == "interpolation") {
    options.interpolation = parse_interpolation(text);
  } else if (name == "space") {
    options.space = parse_space(text);
  } else if (name == "samples") {
    options.samples = parse_samples(text);
  } else {
    refuse_name(name);
  }
}

void set(RawLayout& layout, std::string_view name, std::string_view text) {
  if (name == "raw-size") {
    layout.size = parse_triple<std::size_t>(text, "three whole numbers like 256,256,94", [](std::size_t n) { return n > 0; });
  } else if (name == "raw-type") {
    layout.type = parse_sample_type(text);
  } else if (name == "raw-spacing") {
    const auto accept = [](double s) { return std::isfinite(s) && s > 0; };
    layout.spacing = parse_triple<double>(text, "three positive numbers like 1,1,2.5", accept);
  } else if (name == "raw-endian") {
    layout.big_endian = parse_is_big_endian(text);
  } else {
    refuse_name(name);
  }
}

ExtractOptions in_world(const ExtractSettings& settings, const Grid& grid) {
  ExtractOptions options = settings.options;
  if (settings.max_radius) options.max_radius = settings.max_radius->in_world(grid);
  if (settings.min_component_size) options.min_component_size = settings.min_component_size->in_world(grid);
  if (settings.event_persistence) options.event_persistence = settings.event_persistence->in_world(grid);
  options.coarse = in_world(settings.goals.coarse, grid);
  for (const auto& goal : settings.goals.refine) options.refine.push_back(in_world(goal, grid));
  return options;
}

}  // namespace isoatlas
