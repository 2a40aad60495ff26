// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>

#include "complex/surface_complex.h"
#include "field/interpolated_field.h"
#include "geometry/triangle_bvh.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// The isosurface of a volume between its samples, for closest-point queries: the faces of its
/// surface complex give the approximate position, the field the exact one. It ends at the volume
/// boundary.
///
/// Parameters and results are in sample-index coordinates, lengths are metric. Immutable and safe
/// to query from any number of threads. The volume's samples must outlive it, the complex need not.
/// 46 bytes per quad and 24 per c-vertex.
class Isosurface {
 public:
  /// @param complex  the volume's surface from parse_surface() with the same rule, interpolation
  ///                 and factor
  /// @cost  O(F log F); one pass over the volume in addition if samples may be NaN
  Isosurface(const VolumeView& volume, const InsideRule& rule, const SurfaceComplex& complex,
             Interpolation interpolation = Interpolation::trilinear, std::uint32_t supersample = 1,
             const RunControl& control = {});

  struct Hit {
    Vec3 point{};
    double distance =
        std::numeric_limits<double>::infinity();  ///< infinity: nothing is within `max_distance`
    bool found() const { return distance < std::numeric_limits<double>::infinity(); }
  };

  /// The closest point of the complex's faces (quads are split along their shorter diagonal). In
  /// smooth data these are within a few hundredths of a voxel of the surface, in noise within a
  /// third. Fast: about a microsecond.
  Hit closest_on_faces(Vec3 p, double max_distance = std::numeric_limits<double>::infinity()) const;

  /// The closest point of the surface found from two starts (p moved along the gradient, and the
  /// closest point of the faces) by sliding towards p. So the distance is an upper bound; it is
  /// tight except where several sheets are within the faces' error. Where the gradient vanishes and
  /// no point of the surface is found near the faces, the result is a point of the faces. About two
  /// microseconds near the surface, several times that for tricubic interpolation.
  Hit closest(Vec3 p, double max_distance = std::numeric_limits<double>::infinity()) const;

  /// A point of the surface found from p alone: by Newton's method along the gradient, then, if it
  /// is farther than `exact_above`, by sliding towards p. The distance is an upper bound, too, but
  /// there is no search: if p is far away, the point may be on another sheet, or none is found.
  Hit find_nearby(Vec3 p, double exact_above = 0) const;

  /// An upper bound of the distance from p to the surface: 1.1 times the first-order distance,
  /// proved by a change of sign along the gradient; infinity if the sign does not change there. A
  /// tenth of a microsecond.
  /// @param cursor  for field(); consecutive points should be near each other
  double distance_upper_bound(Vec3 p, InterpolatedField::Cursor& cursor) const;

  /// The smaller of the distances that find_nearby() and, above `exact_above`, closest() find.
  double distance(Vec3 p, double exact_above) const;

  /// A point of the surface near p (within one smallest spacing), by Newton's method along the
  /// gradient.
  std::optional<Vec3> onto_surface(Vec3 p) const;

  /// The point where the surface intersects the grid edge from the sample at `low` to the next one
  /// along `axis`; absent if it does not.
  std::optional<Vec3> on_edge(Vec3 low, int axis) const;

  /// The field's direction of steepest descent, from inside to outside: of unit length in the
  /// metric; zero where the gradient is zero.
  Vec3 normal(Vec3 p) const;

  /// Faces as triangles with metric positions. The first side of each half of a quad is the quad's
  /// diagonal.
  const TriangleBvh& faces() const { return faces_; }
  Vec3 spacing() const { return spacing_; }
  double voxel() const { return voxel_; }  ///< smallest spacing of the volume itself
  const InterpolatedField& field() const { return field_; }

 private:
  // All points below are metric.
  struct FirstOrder {
    double offset;    // first-order signed distance to the surface, > 0 inside
    Vec3 steepest{};  // unit gradient, towards the inside; zero where it vanishes
  };
  struct SurfacePoint {  // a point of the surface
    Vec3 point, steepest;
  };
  FirstOrder evaluate(Vec3 p) const;
  FirstOrder evaluate(Vec3 p, InterpolatedField::Cursor& cursor) const;
  std::optional<SurfacePoint> project(Vec3 p, double reach) const;
  std::optional<SurfacePoint> bisect(Vec3 inside, Vec3 outside) const;
  SurfacePoint slide_towards(Vec3 p, SurfacePoint surface_point) const;
  Vec3 clip_to_volume(Vec3 p, Vec3 move) const;
  Vec3 clamped(Vec3 p) const;
  Vec3 to_metric(Vec3 p) const { return {p.x * spacing_.x, p.y * spacing_.y, p.z * spacing_.z}; }
  Vec3 to_index(Vec3 p) const { return {p.x / spacing_.x, p.y / spacing_.y, p.z / spacing_.z}; }

  Vec3 spacing_;
  double voxel_;  // smallest spacing of the volume
  InterpolatedField field_;
  TriangleBvh faces_;
};

}  // namespace isoatlas::detail
