// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "isoatlas/error.h"
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

std::string_view name(Quantity quantity) { return kDescriptions[static_cast<std::size_t>(quantity)].name; }

std::optional<Quantity> quantity_named(std::string_view name) {
  const auto end = kDescriptions.begin() + kQuantityCount;  // `custom` cannot be named
  const auto it = std::find_if(kDescriptions.begin(), end, [&](const Description& d) { return d.name == name; });
  if (it == end) return std::nullopt;
  return static_cast<Quantity>(it - kDescriptions.begin());
}

std::string_view name(const Constraint& constraint) {
  return constraint.custom ? std::string_view(constraint.custom->name) : name(constraint.quantity);
}

Constraint sized_by(std::function<double(Vec3)> longest_edge) {
  return bounded(
      "sizing-field",
      [longest_edge = std::move(longest_edge)](const CellGeometry& cell) {
        double most = 0;
        for (const std::array<Vec3, 3>& t : cell.triangles) {
          for (const Vec3& end : {t[1], t[2]}) {
            const Vec3 middle{0.5 * (t[0].x + end.x), 0.5 * (t[0].y + end.y), 0.5 * (t[0].z + end.z)};
            const double allowed = longest_edge(middle);
            if (!(allowed > 0)) throw Error(ErrorCode::bad_argument, "the sizing field is not positive everywhere");
            most = std::max(most, std::hypot(end.x - t[0].x, end.y - t[0].y, end.z - t[0].z) / allowed);
          }
        }
        return most;
      },
      1);
}

Unit unit(Quantity quantity) { return kDescriptions[static_cast<std::size_t>(quantity)].unit; }

}  // namespace isoatlas
