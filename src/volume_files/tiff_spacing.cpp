// SPDX-License-Identifier: Apache-2.0
#include "volume_files/tiff_spacing.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

namespace isoatlas::detail::io {

namespace {

std::string number_text(double number) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.10g", number);
  return text.data();
}

}  // namespace

Vec3 take_spacing(const TiffStack& stack, VolumeSource& source) {
  const std::string unit(symbol(stack.unit));
  if (!unit.empty()) {
    source.decisions.push_back({"unit", unit});
  }
  if (stack.rescale) {
    source.decisions.push_back({"rescale", "slope " + number_text(stack.rescale->slope) +
                                               ", intercept " +
                                               number_text(stack.rescale->intercept)});
  }
  std::string missing;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!stack.spacing[axis])
      missing += (missing.empty() ? "" : " and ") + std::string(1, "xyz"[axis]);
  }
  source.has_spacing =
      std::ranges::any_of(stack.spacing, [](const auto& length) { return length.has_value(); });
  if (source.has_spacing && !missing.empty()) {
    source.warnings.push_back("states no voxel size along " + missing + "; 1" +
                              (unit.empty() ? "" : " " + unit) + " is assumed there");
  }
  return {stack.spacing[0].value_or(1), stack.spacing[1].value_or(1), stack.spacing[2].value_or(1)};
}

}  // namespace isoatlas::detail::io
