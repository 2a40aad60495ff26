// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>

#include "complex/surface_complex.h"
#include "field/interpolated_field.h"
#include "geometry/triangle_tree.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// The isosurface of a volume between its samples, to be asked for closest points: the faces of its surface complex say where it is, the
/// field where exactly. It ends at the volume's border.
///
/// Points are in sample-index coordinates, lengths in the complex's metric (spacing applied). Immutable; any number of threads
/// may ask at once. The volume's samples must outlive it, the complex need not. 46 bytes per quad beside 24 per c-vertex.
class Isosurface {
 public:
  /// @param complex  the volume's surface, as parse_surface() makes it with the same rule, interpolation and factor
  /// @cost  O(F log F); for samples that may be NaN one pass over the volume besides
  Isosurface(const VolumeView& volume, const InsideRule& rule, const SurfaceComplex& complex,
             Interpolation interpolation = Interpolation::trilinear, std::uint32_t supersample = 1, const RunControl& control = {});

  struct Hit {
    Vec3 point{};
    double distance = std::numeric_limits<double>::infinity();  ///< infinity: nothing is within `at_most`
    bool found() const { return distance < std::numeric_limits<double>::infinity(); }
  };

  /// The cheap one: the closest point of the complex's faces (quads cut along their shorter diagonal), which in smooth data are
  /// within a few hundredths of a voxel of the surface, in noise within a third. About a microsecond.
  Hit closest_on_faces(Vec3 p, double at_most = std::numeric_limits<double>::infinity()) const;

  /// The closest point of the surface that is found from two starts, p moved along the gradient and the closest point
  /// of the faces, by sliding towards p; so the distance is an upper bound, tight but for surfaces with several sheets within
  /// the faces' error. Where the gradient vanishes and no point of the surface is found near the faces, it is one of the faces'.
  /// About two microseconds near the surface, several times that if tricubic.
  Hit closest(Vec3 p, double at_most = std::numeric_limits<double>::infinity()) const;

  /// A point of the surface, found from p alone: by Newton's method along the gradient, then, if it is farther than
  /// `enough`, by sliding towards p. The distance is an upper bound too, but nothing is searched for: on another sheet, or nothing
  /// at all, where p is not near.
  Hit nearby(Vec3 p, double enough = 0) const;

  /// An upper bound on the distance from p to the surface, 1.1 times the first-order one, proved by a change of sign on the way along
  /// the gradient; infinity if the sign does not change there. A tenth of a microsecond.
  /// @param cursor  for field(); points that follow each other are best near each other
  double rough_distance(Vec3 p, InterpolatedField::Cursor& cursor) const;

  /// The distance of the nearest point that nearby() and, beyond `enough`, closest() find.
  double distance(Vec3 p, double enough) const;

  /// A point of the surface near p (within one smallest spacing), by Newton's method along the gradient.
  std::optional<Vec3> onto_surface(Vec3 p) const;

  /// Where the surface meets the grid edge from the sample at `low` to the next one along `axis`; nothing if it does not.
  std::optional<Vec3> on_edge(Vec3 low, int axis) const;

  /// The field's direction of steepest descent, from inside to outside: of unit length in the metric; zero where there is none.
  Vec3 normal(Vec3 p) const;

  /// Faces as triangles, positions in the metric. The first side of each half of a quad is the quad's diagonal.
  const TriangleTree& faces() const { return faces_; }
  Vec3 spacing() const { return spacing_; }
  double voxel() const { return voxel_; }  ///< smallest spacing of the volume itself
  const InterpolatedField& field() const { return field_; }

 private:
  // All points below are in the metric.
  struct Evidence {
    double offset;    // first-order signed distance to the surface, > 0 inside
    Vec3 steepest{};  // unit gradient, towards the inside; zero where it vanishes
  };
  struct Foot {  // a point of the surface
    Vec3 point, steepest;
  };
  Evidence look(Vec3 p) const;
  Evidence look(Vec3 p, InterpolatedField::Cursor& cursor) const;
  std::optional<Foot> project(Vec3 p, double reach) const;
  std::optional<Foot> between(Vec3 inside, Vec3 outside) const;
  Foot slide_towards(Vec3 p, Foot foot) const;
  Vec3 without_leaving(Vec3 p, Vec3 move) const;
  Vec3 clamped(Vec3 p) const;
  Vec3 to_metric(Vec3 p) const { return {p.x * spacing_.x, p.y * spacing_.y, p.z * spacing_.z}; }
  Vec3 to_index(Vec3 p) const { return {p.x / spacing_.x, p.y / spacing_.y, p.z / spacing_.z}; }

  Vec3 spacing_;
  double voxel_;  // smallest spacing of the volume
  InterpolatedField field_;
  TriangleTree faces_;
};

}  // namespace isoatlas::detail
