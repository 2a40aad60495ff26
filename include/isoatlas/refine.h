// SPDX-License-Identifier: Apache-2.0
// What can be asked of a level.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "isoatlas/export.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// What can be bounded. The first six are the paper's error metrics (section 3.5), measured per
/// cell and bounded from above.
enum class Quantity {
  max_distance,    ///< largest distance between the cell's surface and the mesh, both ways; world
                   ///< length
  mean_distance,   ///< mean distance of the cell's c-vertices from the mesh; world length
  area_curvature,  ///< surface area / area seen along the triangles' normals; ratio >= 1
  area_curvature_smooth,  ///< the same with normals interpolated between the vertices; ratio >= 1
  geodesic_ratio,  ///< geodesic / straight distance from the site to the cell's border, at most;
                   ///< ratio >= 1
  normal_angle,  ///< angles between normals summed along a geodesic from the site, at most; degrees
  max_vertices,  ///< no more vertices than this
  min_vertices,  ///< no fewer
  min_edge,      ///< no shorter edge; world length
  max_edge,      ///< no longer edge; world length
  min_aspect,    ///< no triangle with a smaller ratio of shortest to longest edge; (0, 1)
  custom,        ///< a metric of the caller's own, bounded from above: Constraint::custom
};
inline constexpr std::size_t kMetricCount = 6;
inline constexpr std::size_t kQuantityCount = 11;  ///< without `custom`

enum class Unit { length, ratio, degrees, count, number };

ISOATLAS_API std::string_view name(
    Quantity quantity);  ///< as on the command line: "max-distance" ... "min-aspect"
ISOATLAS_API std::optional<Quantity> quantity_named(
    std::string_view name);  ///< none if there is no such quantity
ISOATLAS_API Unit unit(Quantity quantity);
constexpr bool is_metric(Quantity quantity) {
  return static_cast<std::size_t>(quantity) < kMetricCount;
}
/// min_vertices, min_edge and min_aspect are bounded from below, all others from above.
constexpr bool is_lower_bound(Quantity quantity) {
  return quantity == Quantity::min_vertices || quantity == Quantity::min_edge ||
         quantity == Quantity::min_aspect;
}

/// A length in world units, or in voxels: `0.4`, `0.5 * vx`.
struct Length {
  double value = 0;
  bool in_voxels = false;

  Length() = default;
  Length(double world) : value(world) {}
  Length(double number, bool voxels) : value(number), in_voxels(voxels) {}
  friend Length operator*(double factor, Length length) {
    return {factor * length.value, length.in_voxels};
  }
  friend bool operator==(const Length&, const Length&) = default;
};
inline const Length vx{1, true};  ///< one voxel: the smallest spacing

/// A Voronoi cell of the surface and the mesh around its vertex, for a metric of the caller's own.
/// World coordinates.
struct CellGeometry {
  Vec3 vertex;                    ///< of the mesh
  Vec3 normal;                    ///< of the isosurface there, unit, outward
  std::span<const Vec3> points;   ///< P x 3: the c-vertices of the cell, on the isosurface
  std::span<const Vec3> normals;  ///< P x 3: unit normals there, outward; zero where there is none
  std::span<const double> areas;  ///< P: area of the isosurface that belongs to each
  std::span<const std::array<Vec3, 3>> triangles{};  ///< T x 3 x 3: the triangles with a corner at
                                                     ///< the vertex, which is their first one
};

/// A metric of the caller's own. The function is called by several threads at once; it must depend
/// on its argument alone.
struct CustomMetric {
  std::string name;  ///< for the report
  std::function<double(const CellGeometry&)> value;
};

/// A soft constraint: one quantity and its bound.
struct Constraint {
  Quantity quantity = Quantity::max_distance;
  double bound = 0;
  bool is_default = false;  ///< nobody asked for it: worked for like the others, but no failure
                            ///< where it is not met
  bool in_voxels = false;  ///< the bound is a length in voxels; extract() reports it in world units
  std::shared_ptr<const CustomMetric> custom{};  ///< of Quantity::custom
  friend bool operator==(const Constraint&, const Constraint&) = default;
};

/// Largest distance between surface and mesh, both ways.
inline Constraint within(Length distance) {
  return {Quantity::max_distance, distance.value, false, distance.in_voxels};
}
/// Any quantity with its bound; a length may be in voxels.
inline Constraint bounded(Quantity quantity, Length bound) {
  return {quantity, bound.value, false, bound.in_voxels};
}

/// A metric of the caller's own, bounded from above in every cell: cells that violate it become
/// smaller.
inline Constraint bounded(std::string name, std::function<double(const CellGeometry&)> metric,
                          double bound) {
  Constraint out{Quantity::custom, bound};
  out.custom =
      std::make_shared<const CustomMetric>(CustomMetric{std::move(name), std::move(metric)});
  return out;
}

/// A sizing field: no edge is longer than the field says at its middle. Reported as "sizing-field",
/// the largest ratio of the two.
ISOATLAS_API Constraint sized_by(std::function<double(Vec3)> longest_edge);

/// The name of the quantity, or of the caller's metric.
ISOATLAS_API std::string_view name(const Constraint& constraint);

/// What one level has to be, the more important constraints first: where they pull apart, an
/// earlier one wins. Topology always comes before all of them.
struct LevelGoal : std::vector<Constraint> {
  using std::vector<Constraint>::vector;
  LevelGoal(const Constraint& constraint) : std::vector<Constraint>{constraint} {}
};

/// The default bound on the distance: half a voxel, or an eighth of the largest spacing where that
/// is more. The surface between thick layers is interpolated, so a mesh that follows it more
/// closely is not closer to the object.
inline LevelGoal default_goal() { return Constraint{Quantity::max_distance, 0.5, true, true}; }

/// Where a level's vertices sit. surface: on the isosurface, the same in all levels. balanced: per
/// level, moved along the surface's normal so that the mesh lies evenly on both sides of the
/// surface; boundary vertices stay.
enum class Placement { surface, balanced };

/// One metric over the cells of a level.
struct MetricSummary {
  double maximum = 0, mean = 0;  ///< unit as the quantity says
};

/// A constraint, and what became of it.
struct ConstraintResult {
  Constraint constraint;
  double reached = 0;
  bool satisfied = false;
  std::string reason;  ///< if not met: what stood in its way, with figures
};

/// Why a badly shaped triangle could not be mended: what keeps the ends of its shortest edge where
/// they are.
enum class ShapeObstacle {
  none,           ///< nothing in particular: no place within reach is better and within the bounds
  earlier_level,  ///< they are vertices of an earlier level
  self_intersection,  ///< elsewhere triangles would meet
  multi_sheet,        ///< other pieces of the surface are in the same grid cell
};

}  // namespace isoatlas
