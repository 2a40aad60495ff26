// SPDX-License-Identifier: Apache-2.0
#include "isosurface/isosurface.h"

#include <algorithm>
#include <cmath>

#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

// Lengths in voxels (smallest spacings).
constexpr double kOnSurface = 1e-7;  // a point this close to the surface counts as on it
constexpr double kLastStep =
    1e-5;                     // after a Newton step this short the surface is not evaluated again
constexpr double kReach = 1;  // largest distance of a start from the surface that it is moved onto
constexpr double kDirectReach = 2;  // the same for the query point
constexpr double kMaxDetour =
    0.1;  // if the result is this much farther than the faces, there may be a nearer point
constexpr double kFaceError =
    0.5;  // faces farther than this beyond `max_distance` are useless as a start
constexpr double kCloseEnough = 1e-4;  // nearer results are not improved
constexpr double kOvershoot =
    1.1;  // factor on the first-order distance, up to which a change of sign is searched for
constexpr int kNewtonSteps = 8;
constexpr int kBisections = 30;
constexpr int kSlides = 12;
constexpr double kSlideDone =
    1e-3;  // sine of the angle between the surface's normal and the direction to p

TriangleBvh make_bvh(const SurfaceComplex& complex, const RunControl& control) {
  std::vector<Vec3> points;
  points.reserve(complex.positions.size());
  for (const Vec3& p : complex.positions) points.push_back(to_metric(p, complex.spacing));
  std::vector<Triangle> triangles;
  triangles.reserve(2 * complex.faces.size());
  for (const Face& f : complex.faces) {
    const auto& c = f.corner;
    if (f.is_triangle()) {
      triangles.push_back({c[0], c[1], c[2]});
      continue;
    }
    const bool first =
        squared_length(points[c[0]] - points[c[2]]) <= squared_length(points[c[1]] - points[c[3]]);
    triangles.push_back(first ? Triangle{c[2], c[0], c[1]} : Triangle{c[1], c[3], c[0]});
    triangles.push_back(first ? Triangle{c[0], c[2], c[3]} : Triangle{c[3], c[1], c[2]});
  }
  return {std::move(points), triangles, control};
}

}  // namespace

Isosurface::Isosurface(const VolumeView& volume, const InsideRule& rule,
                       const SurfaceComplex& complex, Interpolation interpolation,
                       std::uint32_t supersample, const RunControl& control)
    : spacing_(complex.spacing),
      voxel_(supersample * std::min({spacing_.x, spacing_.y, spacing_.z})),
      field_(volume, rule, interpolation, supersample),
      faces_(make_bvh(complex, control)) {}

Vec3 Isosurface::clamped(Vec3 p) const {
  const Vec3 last = to_metric(field_.last());
  return {std::clamp(p.x, 0.0, last.x), std::clamp(p.y, 0.0, last.y), std::clamp(p.z, 0.0, last.z)};
}

Isosurface::FirstOrder Isosurface::evaluate(Vec3 p) const {
  InterpolatedField::Cursor cursor;
  return evaluate(p, cursor);
}

Isosurface::FirstOrder Isosurface::evaluate(Vec3 p, InterpolatedField::Cursor& cursor) const {
  const InterpolatedField::Value f = field_.at(to_index(p), cursor);
  const Vec3 g = to_index(f.gradient);
  const double slope = length(g);
  if (!(slope > 0)) return {f.value == 0 ? 0 : std::copysign(INFINITY, f.value), {}};
  return {f.value / slope, (1 / slope) * g};
}

// Removes the components of a move that would leave the volume from a point on the volume
// boundary.
Vec3 Isosurface::clip_to_volume(Vec3 p, Vec3 move) const {
  const Vec3 last = to_metric(field_.last());
  const auto clip = [](double x, double end, double dx) {
    return (x <= 0 && dx < 0) || (x >= end && dx > 0) ? 0 : dx;
  };
  return {clip(p.x, last.x, move.x), clip(p.y, last.y, move.y), clip(p.z, last.z, move.z)};
}

std::optional<Isosurface::SurfacePoint> Isosurface::project(const Vec3 start, double reach) const {
  Vec3 p = clamped(start);
  std::optional<Vec3> inside, outside;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const FirstOrder at = evaluate(p);
    if (std::abs(at.offset) <= kOnSurface * voxel_) return SurfacePoint{p, at.steepest};
    (at.offset > 0 ? inside : outside) = p;
    if (!std::isfinite(at.offset)) break;
    // On the volume boundary the surface is a curve, which is reached along that boundary.
    const Vec3 direction = clip_to_volume(p, -std::copysign(1.0, at.offset) * at.steepest);
    const double slope = squared_length(direction);
    if (!(slope > 1e-6)) break;
    const double distance_along =
        std::abs(at.offset) / slope;  // in units of `direction`, whose length is sqrt(slope)
    p = clamped(p + std::min(distance_along, voxel_ / std::sqrt(slope)) * direction);
    if (distance_along <= kLastStep * voxel_) return SurfacePoint{p, at.steepest};
    if (!(squared_length(p - start) <= reach * reach)) break;
  }
  if (inside && outside) return bisect(*inside, *outside);
  return std::nullopt;
}

// Newton's method can oscillate at a kink of the field; bisection between the two sides always
// converges.
std::optional<Isosurface::SurfacePoint> Isosurface::bisect(Vec3 inside, Vec3 outside) const {
  for (int k = 0; k < kBisections; ++k) {
    const Vec3 middle = 0.5 * (inside + outside);
    const FirstOrder at = evaluate(middle);
    if (std::abs(at.offset) <= kOnSurface * voxel_ || k + 1 == kBisections)
      return SurfacePoint{middle, at.steepest};
    (at.offset > 0 ? inside : outside) = middle;
  }
  return std::nullopt;
}

// At the closest point to p the direction to p is the surface's normal. Steps go along the tangent
// plane and back onto the surface, and are kept if they lead nearer.
Isosurface::SurfacePoint Isosurface::slide_towards(Vec3 p, SurfacePoint surface_point) const {
  double squared = squared_length(p - surface_point.point), share = 1;
  for (int k = 0; k < kSlides && share >= 1.0 / 64; ++k) {
    const Vec3 distance_along = p - surface_point.point;
    Vec3 along =
        distance_along - dot(distance_along, surface_point.steepest) * surface_point.steepest;
    const Vec3 clipped = clip_to_volume(surface_point.point, along);
    // On the volume boundary: move along the curve in which the surface ends.
    if (!(clipped == along)) {
      const Vec3 wall = along - clipped, curve = normalized(cross(surface_point.steepest, wall));
      along = dot(distance_along, curve) * curve;
    }
    const double step = length(along);
    if (step <= std::max(kSlideDone * std::sqrt(squared), kOnSurface * voxel_)) break;
    const auto next = project(surface_point.point + (share * std::min(1.0, voxel_ / step)) * along,
                              kReach * voxel_);
    const double nearer = next ? squared_length(p - next->point) : INFINITY;
    if (!(nearer < squared)) {
      share /= 4;
      continue;
    }
    const bool little = nearer > (1 - 1e-6) * squared;
    surface_point = *next;
    squared = nearer;
    if (little) break;
  }
  return surface_point;
}

Isosurface::Hit Isosurface::closest_on_faces(Vec3 p, double max_distance) const {
  const TriangleBvh::Hit hit = faces_.closest(to_metric(p), max_distance);
  if (!hit.found()) return {};
  return {to_index(hit.point), std::sqrt(hit.squared_distance)};
}

Isosurface::Hit Isosurface::find_nearby(const Vec3 index, double exact_above) const {
  const Vec3 p = to_metric(index);
  const std::optional<SurfacePoint> surface_point = project(p, kDirectReach * voxel_);
  if (!surface_point) return {};
  const double distance = length(p - surface_point->point);
  if (distance <= exact_above) return {to_index(surface_point->point), distance};
  const SurfacePoint slid_point = slide_towards(p, *surface_point);
  return {to_index(slid_point.point), length(p - slid_point.point)};
}

Isosurface::Hit Isosurface::closest(const Vec3 index, double max_distance) const {
  const Vec3 p = to_metric(index);
  std::optional<SurfacePoint> best = project(p, std::min(kDirectReach * voxel_, max_distance));
  double distance = best ? length(p - best->point) : INFINITY;
  if (distance > kCloseEnough * voxel_) {
    const TriangleBvh::Hit face =
        faces_.closest(p, std::min(distance, max_distance + kFaceError * voxel_));
    const double to_face = face.found() ? std::sqrt(face.squared_distance) : INFINITY;
    const auto offer = [&](Vec3 start) {
      const std::optional<SurfacePoint> surface_point = project(start, kReach * voxel_);
      if (surface_point && (!best || length(p - surface_point->point) < length(p - best->point)))
        best = surface_point;
    };
    if (face.found()) offer(face.point);
    if (!best) return to_face <= max_distance ? Hit{to_index(face.point), to_face} : Hit{};
    best = slide_towards(p, *best);
    distance = length(p - best->point);
    if (distance > to_face + kMaxDetour * voxel_) {  // next to a crease sliding can end in a local
                                                     // minimum: try other starts around it
      for (const double step : {-0.5, 0.5}) {
        for (const Vec3 aside : {Vec3{step, 0, 0}, Vec3{0, step, 0}, Vec3{0, 0, step}})
          offer(face.point + voxel_ * aside);
      }
      best = slide_towards(p, *best);
      distance = length(p - best->point);
    }
  }
  return distance <= max_distance ? Hit{to_index(best->point), distance} : Hit{};
}

double Isosurface::distance_upper_bound(const Vec3 index, InterpolatedField::Cursor& cursor) const {
  const Vec3 p = to_metric(index);
  const FirstOrder at = evaluate(p, cursor);
  if (!std::isfinite(at.offset)) return INFINITY;
  const double distance_along = kOvershoot * std::abs(at.offset) + kOnSurface * voxel_;
  const Vec3 end = clamped(p - std::copysign(distance_along, at.offset) * at.steepest);
  if ((at.offset >= 0) == (field_.at(to_index(end), cursor).value >= 0)) return INFINITY;
  // Outside the volume the field is that of the nearest point on the volume boundary.
  return std::max(length(end - p), length(clamped(p) - p));
}

double Isosurface::distance(const Vec3 index, double exact_above) const {
  const double near = find_nearby(index, exact_above).distance;
  return near <= exact_above ? near : std::min(near, closest(index, near).distance);
}

std::optional<Vec3> Isosurface::onto_surface(Vec3 p) const {
  const std::optional<SurfacePoint> surface_point = project(to_metric(p), kReach * voxel_);
  if (!surface_point) return std::nullopt;
  return to_index(surface_point->point);
}

std::optional<Vec3> Isosurface::on_edge(const Vec3 low, int axis) const {
  const std::optional<double> t = field_.zero_on_edge(low, axis);
  if (!t) return std::nullopt;
  return low + *t * Vec3{axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0};
}

Vec3 Isosurface::normal(Vec3 p) const {
  const Vec3 here = to_metric(p);
  Vec3 steepest = evaluate(here).steepest;
  if (steepest == Vec3{}) {  // the gradient vanishes here: use the cells around
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) {
        for (const double z : {-0.5, 0.5})
          steepest = steepest + to_index(field_.at(p + Vec3{x, y, z}).gradient);
      }
    }
  }
  return -1 * normalized(steepest);
}

}  // namespace isoatlas::detail
