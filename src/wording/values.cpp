// SPDX-License-Identifier: Apache-2.0
#include "wording/values.h"

#include <cmath>

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

std::optional<Length> length_of(std::string_view text) { return measure_of<Length>(text, "mm"); }
std::optional<SpaceSize> space_size_of(std::string_view text) { return measure_of<SpaceSize>(text, "mm3"); }

}  // namespace isoatlas
