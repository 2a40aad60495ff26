// SPDX-License-Identifier: Apache-2.0
#include "values.h"

#include <cmath>

namespace isoatlas::tool {

std::optional<Length> length_of(std::string_view text) {
  const auto strip = [&text](std::string_view unit) {
    if (!text.ends_with(unit)) return false;
    text.remove_suffix(unit.size());
    return true;
  };
  Length length;
  length.in_voxels = strip("vx");
  if (!length.in_voxels) strip("mm");
  const auto value = parse_whole<double>(text);
  if (!value || !std::isfinite(*value) || *value < 0) return std::nullopt;
  length.value = *value;
  return length;
}

}  // namespace isoatlas::tool
