// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "isoatlas/refine.h"

namespace isoatlas {
namespace {

struct Description {
  std::string_view name;
  Unit unit;
};

constexpr std::array<Description, kQuantityCount + 1> kDescriptions{{
    {"max-distance", Unit::length},
    {"mean-distance", Unit::length},
    {"area-curvature", Unit::ratio},
    {"area-curvature-smooth", Unit::ratio},
    {"geodesic-ratio", Unit::ratio},
    {"normal-angle", Unit::degrees},
    {"max-vertices", Unit::count},
    {"min-vertices", Unit::count},
    {"min-edge", Unit::length},
    {"max-edge", Unit::length},
    {"min-aspect", Unit::ratio},
    {"custom", Unit::number},
}};

}  // namespace

std::string_view name(Quantity quantity) {
  return kDescriptions[static_cast<std::size_t>(quantity)].name;
}

std::optional<Quantity> quantity_named(std::string_view name) {
  const auto end = kDescriptions.begin() + kQuantityCount;  // `custom` cannot be named
  const auto it = std::find_if(kDescriptions.begin(), end,
                               [&](const Description& d) { return d.name == name; });
  if (it == end) return std::nullopt;
  return static_cast<Quantity>(it - kDescriptions.begin());
}

std::string_view name(const Constraint& constraint) {
  return constraint.custom ? std::string_view(constraint.custom->name) : name(constraint.quantity);
}

Unit unit(Quantity quantity) { return kDescriptions[static_cast<std::size_t>(quantity)].unit; }

}  // namespace isoatlas
