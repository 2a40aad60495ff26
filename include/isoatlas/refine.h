// SPDX-License-Identifier: Apache-2.0
// Constraints of a level of detail, and the results.
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

/// A quantity of a level that can have a bound. The first six are metrics: the error measures of
/// the paper (section 3.5), evaluated per Voronoi cell and bounded from above. A Voronoi cell is
/// the part of the surface, represented by its c-vertices, that is nearest to one mesh vertex, its
/// site.
enum class Quantity {
  /// Largest two-sided distance between the surface in a Voronoi cell and the mesh; world units.
  max_distance,
  /// Mean distance of the c-vertices of a Voronoi cell from the mesh; world units.
  mean_distance,
  /// Surface area of a Voronoi cell divided by its area projected along the normals of the
  /// triangles; ratio >= 1.
  area_curvature,
  /// area_curvature with normals interpolated between the vertices; ratio >= 1.
  area_curvature_smooth,
  /// Largest ratio of geodesic to straight distance from the site to the boundary of its
  /// Voronoi cell; ratio >= 1.
  geodesic_ratio,
  /// Largest sum of the angles between normals along a geodesic from the site to the boundary of
  /// its Voronoi cell; degrees.
  normal_angle,
  max_vertices,  ///< number of vertices, bounded from above
  min_vertices,  ///< number of vertices, bounded from below
  min_edge,      ///< length of the shortest edge, bounded from below; world units
  max_edge,      ///< length of the longest edge, bounded from above; world units
  min_aspect,    ///< smallest aspect ratio of a triangle (shortest / longest edge); (0, 1)
  custom,        ///< a metric defined by the caller, bounded from above: Constraint::custom
};
inline constexpr std::size_t kMetricCount = 6;     ///< number of metrics, without `custom`
inline constexpr std::size_t kQuantityCount = 11;  ///< number of quantities, without `custom`

/// The unit of a quantity. `length`: world units; `number`: that of a custom metric.
enum class Unit { length, ratio, degrees, count, number };

/// The name in reports: "max-distance" ... "min-aspect"; "custom" for a custom metric.
ISOATLAS_API std::string_view name(Quantity quantity);
/// The quantity with this name; absent for an unknown name and for "custom".
ISOATLAS_API std::optional<Quantity> quantity_named(std::string_view name);
/// The unit of a quantity's values and bounds.
ISOATLAS_API Unit unit(Quantity quantity);
/// True for the first six quantities, the error measures of the paper.
constexpr bool is_metric(Quantity quantity) {
  return static_cast<std::size_t>(quantity) < kMetricCount;
}
/// True for min_vertices, min_edge and min_aspect. All other bounds are upper bounds.
constexpr bool is_lower_bound(Quantity quantity) {
  return quantity == Quantity::min_vertices || quantity == Quantity::min_edge ||
         quantity == Quantity::min_aspect;
}

/// A length in world units, `0.4`, or in voxels, `0.5 * vx`.
struct Length {
  double value = 0;
  bool in_voxels = false;  ///< false: world units

  Length() = default;
  Length(double world) : value(world) {}
  Length(double number, bool is_in_voxels) : value(number), in_voxels(is_in_voxels) {}
  friend Length operator*(double factor, Length length) {
    return {factor * length.value, length.in_voxels};
  }
  friend bool operator==(const Length&, const Length&) = default;
};
inline const Length vx{1, true};  ///< one voxel: the smallest spacing of the volume

/// The argument of a custom metric: a Voronoi cell of the surface, with P c-vertices, and the T
/// triangles at its mesh vertex. World coordinates.
struct CellGeometry {
  Vec3 vertex;                    ///< the mesh vertex of the Voronoi cell
  Vec3 normal;                    ///< outward unit normal of the isosurface at the vertex
  std::span<const Vec3> points;   ///< P x 3: the c-vertices of the Voronoi cell
  std::span<const Vec3> normals;  ///< P x 3: outward unit normals at the points; zero if undefined
  std::span<const double> areas;  ///< P: area of the isosurface that each point represents
  /// T x 3 x 3: the triangles with a corner at the vertex. The vertex is their first corner.
  std::span<const std::array<Vec3, 3>> triangles{};
};

/// A metric defined by the caller. Several threads call the function at the same time. Its result
/// must depend only on its argument and must not be NaN; an exception ends extract().
struct CustomMetric {
  std::string name;  ///< the name of the constraint in the report
  std::function<double(const CellGeometry&)> value;
};

/// A quantity and its bound. Constraints are soft: if a level cannot satisfy one, extract() does
/// not fail, and the report gives the reason.
struct Constraint {
  Quantity quantity = Quantity::max_distance;
  double bound = 0;  ///< in unit(quantity), or in voxels; above 0
  /// The bound was not requested by the caller. Refinement treats it like other bounds, but a
  /// violation is not a failure (LevelReport::all_satisfied()).
  bool is_default = false;
  bool in_voxels = false;  ///< the bound is a length in voxels; extract() reports it in world units
  std::shared_ptr<const CustomMetric> custom{};  ///< the metric, if `quantity` is `custom`
  friend bool operator==(const Constraint&, const Constraint&) = default;
};

/// An upper bound of the two-sided distance between surface and mesh.
inline Constraint within(Length distance) {
  return {Quantity::max_distance, distance.value, false, distance.in_voxels};
}
/// A bound of any quantity except `custom`. A length may be in voxels.
inline Constraint bounded(Quantity quantity, Length bound) {
  return {quantity, bound.value, false, bound.in_voxels};
}

/// An upper bound of a metric defined by the caller. Voronoi cells that violate it are refined.
/// @param name  the name of the constraint in the report
inline Constraint bounded(std::string name, std::function<double(const CellGeometry&)> metric,
                          double bound) {
  Constraint out{Quantity::custom, bound};
  out.custom =
      std::make_shared<const CustomMetric>(CustomMetric{std::move(name), std::move(metric)});
  return out;
}

/// An edge-length field: an upper bound of the length of an edge that depends on the edge's
/// midpoint. The report calls it "edge-length" and states the largest ratio of edge length to the
/// bound.
/// @param longest_edge  the largest allowed length at a world point, positive, in world units
ISOATLAS_API Constraint sized_by(std::function<double(Vec3)> longest_edge);

/// The name of the constraint's quantity, or of its custom metric.
ISOATLAS_API std::string_view name(const Constraint& constraint);

/// The constraints of one level in order of priority: if two of them conflict, the earlier one is
/// satisfied. The correct topology has priority over all of them.
struct LevelGoal : std::vector<Constraint> {
  using std::vector<Constraint>::vector;
  LevelGoal(const Constraint& constraint) : std::vector<Constraint>{constraint} {}
};

/// The default bound of the two-sided distance: half a voxel, or an eighth of the largest spacing
/// if that is larger. Between thick layers the surface is interpolated, so a mesh that follows it
/// more closely is not closer to the object.
inline LevelGoal default_goal() { return Constraint{Quantity::max_distance, 0.5, true, true}; }

/// Goals of several levels, coarse to fine. The bound of the two-sided distance shrinks by the same
/// factor from each level to the next, from `coarsest` to that of `finest`; the other constraints
/// of `finest` hold in every level. Example: `ladder(4, within(0.5 * vx), 4 * vx)` has the bounds
/// 4, 2, 1 and 0.5 voxels. ExtractOptions::levels chooses `coarsest` from the surface.
/// @param levels  1 or more; 1: only `finest`
/// @param finest  has a bound of max_distance
/// @param coarsest  at least that bound, and in voxels if that bound is
/// @throws Error(bad_argument)
ISOATLAS_API std::vector<LevelGoal> ladder(std::size_t levels, const LevelGoal& finest,
                                           Length coarsest);

/// Where the vertices of a level are placed.
enum class Placement {
  surface,  ///< on the isosurface, at the same positions in all levels
  /// Displaced along the surface normal, in each level separately, so that the distances of the
  /// surface from the mesh have both signs. Boundary vertices are not displaced.
  balanced,
};

/// A metric over the Voronoi cells of a level, in the unit of its quantity.
struct MetricSummary {
  double maximum = 0, mean = 0;
};

/// A constraint and the value that a level reached.
struct ConstraintResult {
  Constraint constraint;
  double reached = 0;      ///< value of the quantity in the level, in unit(constraint.quantity)
  bool satisfied = false;  ///< whether `reached` is within the bound
  std::string reason;      ///< if violated: the obstacle, with figures; otherwise empty
};

/// Why the shape of a bad triangle (see BadTriangle) was not improved by moving its vertices: why
/// both ends of its shortest edge, or the corner at its largest angle, kept their positions.
enum class ShapeObstacle {
  none,               ///< no position within reach is better and satisfies the bounds
  earlier_level,      ///< they are vertices of an earlier level, which are fixed
  self_intersection,  ///< at other positions, triangles would intersect
  multi_sheet,        ///< their grid cells contain several sheets of the surface
};

}  // namespace isoatlas
