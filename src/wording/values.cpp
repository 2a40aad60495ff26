// SPDX-License-Identifier: Apache-2.0
#include "wording/values.h"

#include <cmath>
#include <string>

#include "isoatlas/error.h"

namespace isoatlas {

namespace {

// A number, 0 or more, with "vx" or the world's unit behind it, or nothing.
template <class Measure>
std::optional<Measure> measure_of(std::string_view text, std::string_view world_unit) {
  const auto strip = [&text](std::string_view unit) {
    if (!text.ends_with(unit)) return false;
    text.remove_suffix(unit.size());
    return true;
  };
  Measure measure;
  measure.in_voxels = strip("vx");
  if (!measure.in_voxels) strip(world_unit);
  const auto value = parse_whole<double>(text);
  if (!value || !std::isfinite(*value) || *value < 0) return std::nullopt;
  measure.value = *value;
  return measure;
}

}  // namespace

void refuse_value(std::string_view expected, std::string_view text) {
  throw Error(ErrorCode::bad_argument, "expected " + std::string(expected) + ", got '" + std::string(text) + "'");
}

double parse_finite(std::string_view text) {
  const auto number = parse_whole<double>(text);
  if (!number || !std::isfinite(*number)) refuse_value("a finite number", text);
  return *number;
}

std::optional<Length> length_of(std::string_view text) { return measure_of<Length>(text, "mm"); }
std::optional<SpaceSize> space_size_of(std::string_view text) { return measure_of<SpaceSize>(text, "mm3"); }

}  // namespace isoatlas
