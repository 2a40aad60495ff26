// SPDX-License-Identifier: Apache-2.0
#include "extent_text.h"

#include <algorithm>

#include "text.h"

namespace isoatlas::detail::tool {
namespace {

constexpr std::size_t kMostDescribed = 6;  // components

std::string power_text(double value, const char* power, LengthUnit unit) {
  return number_text(value) + " " + power + " " +
         (unit == LengthUnit::unknown ? "units" : std::string(symbol(unit)));
}

std::string area_text(double area, LengthUnit unit) { return power_text(area, "square", unit); }

/// "12 x 3.5 x 4 mm"
std::string sides_text(const BoundingBox& box, const std::string& unit) {
  return number_text(box.high.x - box.low.x) + " x " + number_text(box.high.y - box.low.y) + " x " +
         number_text(box.high.z - box.low.z) + (unit.empty() ? "" : " " + unit);
}

std::string enclosed_text(const MeshExtent& extent, LengthUnit unit) {
  if (!extent.volume)
    return extent.components == 1 ? "nothing: the mesh is open"
                                  : "nothing: all components are open";
  std::string text = volume_text(*extent.volume, unit);
  if (*extent.volume < 0) text += " (negative: the triangles face inwards)";
  if (extent.open_components > 0)
    text += " in " + counted(extent.components - extent.open_components, "closed component") +
            "; " + counted(extent.open_components, "open component") +
            (extent.open_components == 1 ? " encloses" : " enclose") + " nothing";
  return text;
}

std::string component_text(const ComponentExtent& component, LengthUnit unit,
                           const std::string& bounds_in) {
  return "component " + std::to_string(component.component) + ": " +
         sides_text(component.bounds, bounds_in) + ", area " + area_text(component.area, unit) +
         (component.volume ? ", encloses " + volume_text(*component.volume, unit) : ", open");
}

}  // namespace

std::string volume_text(double volume, LengthUnit unit) {
  return power_text(volume, "cubic", unit);
}

void print_extent(std::ostream& out, const MeshExtent& extent, LengthUnit unit,
                  const std::string& bounds_in) {
  if (extent.components == 0) return;
  out << row("extent", sides_text(extent.bounds, bounds_in) + ", from " +
                           point_text(extent.bounds.low) + " to " + point_text(extent.bounds.high))
      << row("area", area_text(extent.area, unit)) << row("encloses", enclosed_text(extent, unit));
  if (extent.components == 1) return;
  const std::size_t shown = std::min(kMostDescribed, extent.largest.size());
  for (std::size_t i = 0; i < shown; ++i)
    out << row("", component_text(extent.largest[i], unit, bounds_in));
  if (shown < extent.components)
    out << row("", "and " + counted(extent.components - shown, "smaller component"));
}

}  // namespace isoatlas::detail::tool
