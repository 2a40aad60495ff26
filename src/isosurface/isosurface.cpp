// SPDX-License-Identifier: Apache-2.0
#include "isosurface/isosurface.h"

#include <algorithm>
#include <cmath>

#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

// Lengths in voxels (smallest spacings).
constexpr double kOnSurface = 1e-7;    // a point this close to the surface is on it
constexpr double kLastStep = 1e-5;     // a Newton step this short needs no further look
constexpr double kReach = 1;           // how far a start may be from the surface it is moved onto
constexpr double kDirectReach = 2;     // the same for the point that is asked for
constexpr double kStuck = 0.1;         // voxels farther than the faces: there may be something nearer
constexpr double kFaceError = 0.5;     // faces farther than this beyond `at_most` are of no use as a start
constexpr double kCloseEnough = 1e-4;  // nearer than this, nobody looks for something nearer still
constexpr double kOvershoot = 1.1;     // how much farther than the first-order distance a change of sign is looked for
constexpr int kNewtonSteps = 8;
constexpr int kBisections = 30;
constexpr int kSlides = 12;
constexpr double kSlideDone = 1e-3;  // sine of the angle between the surface's normal and the way to p

TriangleTree tree_of(const SurfaceComplex& complex, const RunControl& control) {
  std::vector<Vec3> positions;
  positions.reserve(complex.positions.size());
  for (const Vec3& p : complex.positions) positions.push_back(scaled(p, complex.spacing));
  std::vector<Triangle> triangles;
  triangles.reserve(2 * complex.faces.size());
  for (const Face& f : complex.faces) {
    const auto& c = f.corner;
    if (f.is_triangle()) {
      triangles.push_back({c[0], c[1], c[2]});
      continue;
    }
    const bool first = squared_length(positions[c[0]] - positions[c[2]]) <= squared_length(positions[c[1]] - positions[c[3]]);
    triangles.push_back(first ? Triangle{c[2], c[0], c[1]} : Triangle{c[1], c[3], c[0]});
    triangles.push_back(first ? Triangle{c[0], c[2], c[3]} : Triangle{c[3], c[1], c[2]});
  }
  return {std::move(positions), triangles, control};
}

}  // namespace

Isosurface::Isosurface(const VolumeView& volume, const InsideRule& rule, const SurfaceComplex& complex, Interpolation interpolation,
                       std::uint32_t supersample, const RunControl& control)
    : spacing_(complex.spacing),
      voxel_(supersample * std::min({spacing_.x, spacing_.y, spacing_.z})),
      field_(volume, rule, interpolation, supersample),
      faces_(tree_of(complex, control)) {}

Vec3 Isosurface::clamped(Vec3 p) const {
  const Vec3 last = to_metric(field_.last());
  return {std::clamp(p.x, 0.0, last.x), std::clamp(p.y, 0.0, last.y), std::clamp(p.z, 0.0, last.z)};
}

Isosurface::Evidence Isosurface::look(Vec3 p) const {
  InterpolatedField::Cursor cursor;
  return look(p, cursor);
}

Isosurface::Evidence Isosurface::look(Vec3 p, InterpolatedField::Cursor& cursor) const {
  const InterpolatedField::Value f = field_.at(to_index(p), cursor);
  const Vec3 g = to_index(f.gradient);
  const double slope = length(g);
  if (!(slope > 0)) return {f.value == 0 ? 0 : std::copysign(INFINITY, f.value), {}};
  return {f.value / slope, (1 / slope) * g};
}

// The part of a move that does not lead out of the volume from a point on its border.
Vec3 Isosurface::without_leaving(Vec3 p, Vec3 move) const {
  const Vec3 last = to_metric(field_.last());
  const auto stays = [](double x, double end, double dx) { return (x <= 0 && dx < 0) || (x >= end && dx > 0) ? 0 : dx; };
  return {stays(p.x, last.x, move.x), stays(p.y, last.y, move.y), stays(p.z, last.z, move.z)};
}

std::optional<Isosurface::Foot> Isosurface::project(const Vec3 start, double reach) const {
  Vec3 p = clamped(start);
  std::optional<Vec3> inside, outside;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Evidence at = look(p);
    if (std::abs(at.offset) <= kOnSurface * voxel_) return Foot{p, at.steepest};
    (at.offset > 0 ? inside : outside) = p;
    if (!std::isfinite(at.offset)) break;
    // On the border the surface is a curve, met along the border.
    const Vec3 direction = without_leaving(p, -std::copysign(1.0, at.offset) * at.steepest);
    const double slope = squared_length(direction);
    if (!(slope > 1e-6)) break;
    const double way = std::abs(at.offset) / slope;  // times `direction`, of length sqrt(slope)
    p = clamped(p + std::min(way, voxel_ / std::sqrt(slope)) * direction);
    if (way <= kLastStep * voxel_) return Foot{p, at.steepest};
    if (!(squared_length(p - start) <= reach * reach)) break;
  }
  if (inside && outside) return between(*inside, *outside);
  return std::nullopt;
}

// A kink of the field can make Newton's method go to and fro. Halving the way between the two sides always ends.
std::optional<Isosurface::Foot> Isosurface::between(Vec3 inside, Vec3 outside) const {
  for (int k = 0; k < kBisections; ++k) {
    const Vec3 middle = 0.5 * (inside + outside);
    const Evidence at = look(middle);
    if (std::abs(at.offset) <= kOnSurface * voxel_ || k + 1 == kBisections) return Foot{middle, at.steepest};
    (at.offset > 0 ? inside : outside) = middle;
  }
  return std::nullopt;
}

// On the surface, the closest point to p is where the way to p is the normal. Steps go along the tangent plane and back onto the
// surface, and are kept if they lead nearer.
Isosurface::Foot Isosurface::slide_towards(Vec3 p, Foot foot) const {
  double squared = squared_length(p - foot.point), share = 1;
  for (int k = 0; k < kSlides && share >= 1.0 / 64; ++k) {
    const Vec3 way = p - foot.point;
    Vec3 along = way - dot(way, foot.steepest) * foot.steepest;
    const Vec3 staying = without_leaving(foot.point, along);
    if (!(staying == along)) {  // on the border: along the curve in which the surface ends
      const Vec3 wall = along - staying, curve = normalized(cross(foot.steepest, wall));
      along = dot(way, curve) * curve;
    }
    const double step = length(along);
    if (step <= std::max(kSlideDone * std::sqrt(squared), kOnSurface * voxel_)) break;
    const auto next = project(foot.point + (share * std::min(1.0, voxel_ / step)) * along, kReach * voxel_);
    const double nearer = next ? squared_length(p - next->point) : INFINITY;
    if (!(nearer < squared)) {
      share /= 4;
      continue;
    }
    const bool little = nearer > (1 - 1e-6) * squared;
    foot = *next;
    squared = nearer;
    if (little) break;
  }
  return foot;
}

Isosurface::Hit Isosurface::closest_on_faces(Vec3 p, double at_most) const {
  const TriangleTree::Hit hit = faces_.closest(to_metric(p), at_most);
  if (!hit.found()) return {};
  return {to_index(hit.point), std::sqrt(hit.squared_distance)};
}

Isosurface::Hit Isosurface::nearby(const Vec3 index, double enough) const {
  const Vec3 p = to_metric(index);
  const std::optional<Foot> foot = project(p, kDirectReach * voxel_);
  if (!foot) return {};
  const double distance = length(p - foot->point);
  if (distance <= enough) return {to_index(foot->point), distance};
  const Foot slid = slide_towards(p, *foot);
  return {to_index(slid.point), length(p - slid.point)};
}

Isosurface::Hit Isosurface::closest(const Vec3 index, double at_most) const {
  const Vec3 p = to_metric(index);
  std::optional<Foot> best = project(p, std::min(kDirectReach * voxel_, at_most));
  double distance = best ? length(p - best->point) : INFINITY;
  if (distance > kCloseEnough * voxel_) {
    const TriangleTree::Hit face = faces_.closest(p, std::min(distance, at_most + kFaceError * voxel_));
    const double to_face = face.found() ? std::sqrt(face.squared_distance) : INFINITY;
    const auto offer = [&](Vec3 start) {
      const std::optional<Foot> foot = project(start, kReach * voxel_);
      if (foot && (!best || length(p - foot->point) < length(p - best->point))) best = foot;
    };
    if (face.found()) offer(face.point);
    if (!best) return to_face <= at_most ? Hit{to_index(face.point), to_face} : Hit{};
    best = slide_towards(p, *best);
    distance = length(p - best->point);
    if (distance > to_face + kStuck * voxel_) {  // beside a crease sliding can end in a hollow: look around
      for (const double step : {-0.5, 0.5}) {
        for (const Vec3 aside : {Vec3{step, 0, 0}, Vec3{0, step, 0}, Vec3{0, 0, step}}) offer(face.point + voxel_ * aside);
      }
      best = slide_towards(p, *best);
      distance = length(p - best->point);
    }
  }
  return distance <= at_most ? Hit{to_index(best->point), distance} : Hit{};
}

double Isosurface::rough_distance(const Vec3 index, InterpolatedField::Cursor& cursor) const {
  const Vec3 p = to_metric(index);
  const Evidence at = look(p, cursor);
  if (!std::isfinite(at.offset)) return INFINITY;
  const double way = kOvershoot * std::abs(at.offset) + kOnSurface * voxel_;
  const Vec3 end = clamped(p - std::copysign(way, at.offset) * at.steepest);
  if ((at.offset >= 0) == (field_.at(to_index(end), cursor).value >= 0)) return INFINITY;
  return std::max(length(end - p), length(clamped(p) - p));  // outside the volume, the field is that of the nearest point of the border
}

double Isosurface::distance(const Vec3 index, double enough) const {
  const double near = nearby(index, enough).distance;
  return near <= enough ? near : std::min(near, closest(index, near).distance);
}

std::optional<Vec3> Isosurface::onto_surface(Vec3 p) const {
  const std::optional<Foot> foot = project(to_metric(p), kReach * voxel_);
  if (!foot) return std::nullopt;
  return to_index(foot->point);
}

std::optional<Vec3> Isosurface::on_edge(const Vec3 low, int axis) const {
  const std::optional<double> t = field_.zero_on_edge(low, axis);
  if (!t) return std::nullopt;
  return low + *t * Vec3{axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0};
}

Vec3 Isosurface::normal(Vec3 p) const {
  const Vec3 here = to_metric(p);
  Vec3 steepest = look(here).steepest;
  if (steepest == Vec3{}) {  // flat here: as in the cells around
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) {
        for (const double z : {-0.5, 0.5}) steepest = steepest + to_index(field_.at(p + Vec3{x, y, z}).gradient);
      }
    }
  }
  return -1 * normalized(steepest);
}

}  // namespace isoatlas::detail
