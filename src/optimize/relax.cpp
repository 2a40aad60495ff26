// SPDX-License-Identifier: Apache-2.0
#include "optimize/relax.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/cancel_poll.h"
#include "core/disjoint_sets.h"
#include "core/ids.h"
#include "core/parallel.h"
#include "core/ranges.h"
#include "core/vector_math.h"
#include "embedding/subdivide.h"
#include "error/level_mesh.h"
#include "optimize/face_direction.h"

namespace isoatlas::detail {
namespace {

constexpr double kOvershoot =
    1.12;  // targets a little more than the goal, so that the goal is reached
constexpr int kSteps =
    8;  // more steps do not converge either, and move vertices further, into other triangles
constexpr double kPush = 0.6, kPull = 0.3;  // share of the missing length that is added to the
                                            // shortest and taken from the longest edge
constexpr double kSurfacePull = 0.15;       // share of the distance from the surface
constexpr double kMaxOffset = 0.25;  // largest distance from the surface while pushing, in voxels
constexpr double kMaxFinalOffset = 0.4;        // the same after pushing and while searching
constexpr std::array kSearchSteps{0.2, 0.05};  // voxels
constexpr int kSearchPasses = 4;
constexpr double kMinRelaxationGain = 2e-3;
constexpr double kSeparationWeight =
    0.5;  // an edge of length 0 counts half as bad as a triangle of aspect 0
constexpr std::size_t kTrianglesPerChunk = 4096;  // triangles, of a parallel loop
constexpr std::size_t kFewPerChunk = 64;  // vertices or triangles, each with its neighbourhood
constexpr int kNewtonSteps = 5;
constexpr double kOnSurface = 0.02;
constexpr double kMinVolumeShare =
    0.25;  // smallest share of a component's enclosed volume that must remain
constexpr double kClosedTolerance = 1e-9;  // of a closed surface: sum of its area vectors over its
                                           // area, which is not 0 because of rounding

bool has_room(const MoveBounds& r) {
  return r.low.x < r.high.x || r.low.y < r.high.y || r.low.z < r.high.z;
}

Vec3 clamped(Vec3 p, const MoveBounds& r) {
  return {std::clamp(p.x, r.low.x, r.high.x), std::clamp(p.y, r.low.y, r.high.y),
          std::clamp(p.z, r.low.z, r.high.z)};
}

class Relaxation {
 public:
  Relaxation(std::span<Vec3> points, std::span<const Triangle> triangles,
             const SlackRows<std::uint32_t>& triangles_of,
             const std::function<MoveBounds(std::uint32_t)>& bounds_of,
             const InterpolatedField* field, Vec3 spacing, const RelaxGoal& goal,
             const RunControl& control, std::span<const std::uint32_t> candidates)
      : control_(control),
        poll_(control),
        candidates_(candidates),
        points_(points),
        triangles_(triangles),
        bounds_of_(bounds_of),
        field_(field),
        spacing_(spacing),
        goal_(goal),
        triangles_of_(triangles_of) {}

  std::vector<std::uint32_t> run() {
    active_ = collect_chunks<std::uint32_t>(
        candidates_.size(), kTrianglesPerChunk,
        [&](std::size_t begin, std::size_t end, auto& found) {
          control_.check_cancelled();
          ranges::copy_if(candidates_.subspan(begin, end - begin), std::back_inserter(found),
                          [&](std::uint32_t t) { return is_badly_shaped(t); });
        });
    if (active_.empty()) return {};
    start_.assign(points_.begin(), points_.end());
    push_.resize(points_.size());
    pushes_.assign(points_.size(), 0);
    is_touched_.assign(points_.size(), 0);
    round_.assign(points_.size(), 0);
    seen_.assign(triangles_.size(), 0);
    face_directions_.resize(triangles_.size());
    is_face_direction_known_.assign(triangles_.size(), 0);
    for (int step = 0; goal_.push && step < kSteps && !active_.empty(); ++step) {
      for (const std::uint32_t t : active_) {
        poll_.step();
        push_ends_apart(t);
      }
      move_pushed();
    }
    revert_vertices_off_surface();
    revert_inverted();
    if (goal_.separation > 0) opposite_.assign(triangles_.size(), {kUnknown, kUnknown, kUnknown});
    search();
    revert_flattened_components();
    std::erase_if(touched_, [&](std::uint32_t v) { return points_[v] == start_[v]; });
    std::sort(touched_.begin(), touched_.end());
    return std::move(touched_);
  }

 private:
  std::array<double, 3> edges(std::uint32_t t) const {
    const Triangle& c = triangles_[t];
    return {length(points_[c[1]] - points_[c[0]]), length(points_[c[2]] - points_[c[1]]),
            length(points_[c[0]] - points_[c[2]])};
  }
  bool is_badly_shaped(std::uint32_t t) const {
    const std::array<double, 3> e = edges(t);
    const auto [low, high] = std::minmax_element(e.begin(), e.end());
    return *low < goal_.aspect * *high || *low < goal_.separation;
  }

  bool has_moved_corner(std::uint32_t t) const {
    return std::any_of(triangles_[t].begin(), triangles_[t].end(),
                       [&](std::uint32_t v) { return !(points_[v] == start_[v]); });
  }

  void touch(std::uint32_t v) {
    if (std::exchange(is_touched_[v], std::uint8_t{1}) == 0) touched_.push_back(v);
  }
  // The triangles with a corner that has moved, sorted.
  std::vector<std::uint32_t> moved_triangles() const {
    std::vector<std::uint32_t> out;
    for (const std::uint32_t v : touched_) {
      if (points_[v] == start_[v]) continue;
      const auto one_ring = triangles_of_.row(v);
      out.insert(out.end(), one_ring.begin(), one_ring.end());
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

  void push(std::uint32_t v, Vec3 by) {
    if (pushes_[v]++ == 0) {
      touch(v);
      push_[v] = {};
      pushed_.push_back(v);
    }
    push_[v] = push_[v] + by;
  }

  // Distributes a change of an edge's length to its ends, as far as these are movable.
  void lengthen(std::uint32_t a, std::uint32_t b, double by) {
    const bool a_has_room = has_room(bounds_of_(a)), b_has_room = has_room(bounds_of_(b));
    Vec3 direction = normalized(points_[b] - points_[a]);
    if (direction == Vec3{}) direction = {a < b ? 1.0 : -1.0, 0, 0};
    const double each = a_has_room && b_has_room ? 0.5 * by : by;
    if (a_has_room) push(a, -each * direction);
    if (b_has_room) push(b, each * direction);
  }

  void push_ends_apart(std::uint32_t t) {
    const Triangle& c = triangles_[t];
    const std::array<double, 3> e = edges(t);
    const auto low = static_cast<std::size_t>(std::min_element(e.begin(), e.end()) - e.begin());
    const auto high = static_cast<std::size_t>(std::max_element(e.begin(), e.end()) - e.begin());
    const double missing = kOvershoot * goal_.aspect * e[high] - e[low];
    if (e[low] < goal_.aspect * kOvershoot * 0.98 * e[high]) {
      lengthen(c[low], c[(low + 1) % 3], kPush * missing);
      lengthen(c[high], c[(high + 1) % 3], -kPull * missing);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (e[k] < goal_.separation)
        lengthen(c[k], c[(k + 1) % 3], kPush * (1.02 * goal_.separation - e[k]));
    }
  }

  Vec3 pulled_to_surface(Vec3 p) const {
    if (field_ == nullptr) return p;
    const InterpolatedField::Value f =
        field_->at({p.x / spacing_.x, p.y / spacing_.y, p.z / spacing_.z});
    const Vec3 gradient{f.gradient.x / spacing_.x, f.gradient.y / spacing_.y,
                        f.gradient.z / spacing_.z};
    const double slope = length(gradient);
    const double offset = slope > 0 ? f.value / slope : 0;
    if (!std::isfinite(offset)) return p;
    const double back = std::max(kSurfacePull * std::abs(offset), std::abs(offset) - kMaxOffset);
    return p - std::copysign(std::min(back, kMaxOffset), offset) * ((1 / slope) * gradient);
  }

  void move_pushed() {
    for_each_index(pushed_.size(), kFewPerChunk, &control_, [&](std::size_t i) {
      const std::uint32_t v = pushed_[i];
      const Vec3 p = points_[v] + (1.0 / pushes_[v]) * push_[v];
      const MoveBounds bounds_of = bounds_of_(v);
      points_[v] = clamped(pulled_to_surface(clamped(p, bounds_of)), bounds_of);
      pushes_[v] = 0;
    });
    std::vector<std::uint32_t> one_ring;
    for (const std::uint32_t v : pushed_) {
      poll_.step();
      for (const std::uint32_t t : triangles_of_.row(v)) {
        if (std::exchange(seen_[t], std::uint8_t{1}) == 0) one_ring.push_back(t);
      }
    }
    for (const std::uint32_t t : one_ring) seen_[t] = 0;
    pushed_.clear();
    active_ = collect_chunks<std::uint32_t>(one_ring.size(), kFewPerChunk,
                                            [&](std::size_t begin, std::size_t end, auto& found) {
                                              control_.check_cancelled();
                                              for (std::size_t i = begin; i < end; ++i) {
                                                if (is_below_target(one_ring[i]))
                                                  found.push_back(one_ring[i]);
                                              }
                                            });
    std::sort(active_.begin(), active_.end());
  }
  bool is_below_target(std::uint32_t t) const {
    const std::array<double, 3> e = edges(t);
    const auto [low, high] = std::minmax_element(e.begin(), e.end());
    return *low < 0.98 * kOvershoot * goal_.aspect * *high || *low < goal_.separation;
  }

  Vec3 area(std::uint32_t t, std::span<const Vec3> at) const {
    const Triangle& c = triangles_[t];
    return cross(at[c[1]] - at[c[0]], at[c[2]] - at[c[0]]);
  }

  Vec3 face_direction_at_start(std::uint32_t t) {
    if (std::exchange(is_face_direction_known_[t], std::uint8_t{1})) return face_directions_[t];
    return face_directions_[t] = face_direction(
               t,
               [&](std::uint32_t i) {
                 const Triangle& c = triangles_[i];
                 return std::array<Vec3, 3>{start_[c[0]], start_[c[1]], start_[c[2]]};
               },
               [&](auto add) {
                 for (const std::uint32_t v : triangles_[t]) {
                   for (const std::uint32_t i : triangles_of_.row(v)) add(i);
                 }
               });
  }

  // Pushing pulls vertices back only as far as their boxes allow.
  void revert_vertices_off_surface() {
    for (const std::uint32_t v : touched_) {
      poll_.step();
      if (!(points_[v] == start_[v]) &&
          distance_to_surface(points_[v]) >
              std::max(kMaxFinalOffset, distance_to_surface(start_[v])))
        points_[v] = start_[v];
    }
  }

  // Reverts the corners of inverted triangles until no triangle is inverted.
  void revert_inverted() {
    const std::vector<std::uint32_t> moved = moved_triangles();
    for (bool any = true; any;) {
      any = false;
      for (const std::uint32_t t : moved) {
        poll_.step();
        const Triangle& c = triangles_[t];
        if (!has_moved_corner(t)) continue;
        if (dot(face_direction_at_start(t), area(t, points_)) >= 0) continue;
        for (const std::uint32_t v : c) points_[v] = start_[v];
        any = true;
      }
    }
  }

  // The vertex opposite to corner k across the opposite edge: a flip would connect the two.
  // Computed on first use.
  std::uint32_t opposite(std::uint32_t t, std::size_t k) const {
    std::uint32_t& cached = opposite_[t][k];
    if (cached != kUnknown) return cached;
    cached = kNone;
    const std::uint32_t a = triangles_[t][(k + 1) % 3], b = triangles_[t][(k + 2) % 3];
    for (const std::uint32_t other : triangles_of_.row(a)) {
      const Triangle& c = triangles_[other];
      for (std::size_t m = 0; m < 3; ++m) {
        if (other != t && c[m] == b && c[(m + 1) % 3] == a) cached = c[(m + 2) % 3];
      }
    }
    return cached;
  }

  // Moves the vertices of triangles that are still badly shaped to wherever the worst triangle of
  // their one-ring improves, step by step, as long as a step helps.
  void search() {
    for (const double step : kSearchSteps) {
      control_.check_cancelled();
      std::vector<std::uint32_t> vertices = collect_chunks<std::uint32_t>(
          candidates_.size(), kTrianglesPerChunk,
          [&](std::size_t begin, std::size_t end, auto& found) {
            control_.check_cancelled();
            for (const std::uint32_t t : candidates_.subspan(begin, end - begin))
              add_corners_if_bad(t, found);
          });
      for (const std::uint32_t t : moved_triangles()) {
        poll_.step();
        add_corners_if_bad(t, vertices);
      }
      for (int pass = 0; pass < kSearchPasses && !vertices.empty(); ++pass)
        vertices = improve_in_rounds(std::move(vertices), step);
    }
  }
  void add_corners_if_bad(std::uint32_t t, std::vector<std::uint32_t>& out) const {
    if (quality(t, kNone, {}) < 1)
      out.insert(out.end(), triangles_[t].begin(), triangles_[t].end());
  }

  // Improves vertices with the same result as one after the other in increasing order: each vertex
  // gets a round after the rounds of all previous vertices that it depends on. Vertices of one
  // round do not depend on each other and are improved in parallel.
  // @return the vertices to try again
  std::vector<std::uint32_t> improve_in_rounds(std::vector<std::uint32_t> vertices, double step) {
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    std::erase_if(vertices, [&](std::uint32_t v) { return !has_room(bounds_of_(v)); });
    std::vector<std::uint32_t> first{
        0, 0};  // rounds count from 1; filling `ordered` moves each entry to the end of its round
    for (const std::uint32_t v : vertices) {
      poll_.step();
      std::uint32_t last = 0;
      for_each_dependency(v, [&](std::uint32_t w) { last = std::max(last, round_[w]); });
      round_[v] = last + 1;
      if (first.size() < last + 3) first.push_back(0);
      ++first[last + 2];
    }
    for (std::size_t round = 1; round < first.size(); ++round) first[round] += first[round - 1];
    std::vector<std::uint32_t> ordered(vertices.size());
    for (const std::uint32_t v : vertices) ordered[first[std::exchange(round_[v], 0u)]++] = v;
    std::vector<std::uint32_t> retry;
    for (std::size_t round = 0; round + 2 < first.size(); ++round) {
      const auto own = std::span(ordered).subspan(first[round], first[round + 1] - first[round]);
      const std::vector<std::uint32_t> found = collect_chunks<std::uint32_t>(
          own.size(), kFewPerChunk, [&](std::size_t begin, std::size_t end, auto& out) {
            control_.check_cancelled();
            for (const std::uint32_t v : own.subspan(begin, end - begin)) {
              if (!improve(v, step)) continue;
              out.push_back(v);
              for (const std::uint32_t t : triangles_of_.row(v)) add_corners_if_bad(t, out);
            }
          });
      retry.insert(retry.end(), found.begin(), found.end());
    }
    for (const std::uint32_t v : vertices) {
      if (!(points_[v] == start_[v])) touch(v);
    }
    return retry;
  }

  // All vertices whose points improve() of v uses.
  template <class Visit>
  void for_each_dependency(std::uint32_t v, Visit visit) const {
    for (const std::uint32_t t : triangles_of_.row(v)) {
      for (std::size_t k = 0; k < 3; ++k) {
        visit(triangles_[t][k]);
        if (goal_.separation == 0) continue;
        if (const std::uint32_t o = opposite(t, k); o != kNone) visit(o);
      }
    }
  }

  // Quality of a triangle with vertex v at p; 1 is good enough.
  double quality(std::uint32_t t, std::uint32_t v, Vec3 p) const {
    const Triangle& c = triangles_[t];
    const std::array<Vec3, 3> q{c[0] == v ? p : points_[c[0]], c[1] == v ? p : points_[c[1]],
                                c[2] == v ? p : points_[c[2]]};
    const std::array<double, 3> e{squared_length(q[1] - q[0]), squared_length(q[2] - q[1]),
                                  squared_length(q[0] - q[2])};
    const auto [low, high] = std::minmax_element(e.begin(), e.end());
    const double aspect = *high > 0 ? std::sqrt(*low / *high) / (1.01 * goal_.aspect) : 0;
    if (goal_.separation == 0) return std::min(1.0, aspect);
    double closest = *low;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t o = opposite(t, k);
      if (o != kNone && o != c[k])
        closest = std::min(closest, squared_length((o == v ? p : points_[o]) - q[k]));
    }
    return std::min(
        {1.0, aspect,
         kSeparationWeight + (1 - kSeparationWeight) * std::sqrt(closest) / goal_.separation});
  }
  // @param bound  a result that is no better than this need not be exact
  double worst_in_ring(std::uint32_t v, Vec3 p, double bound) const {
    double worst = 1;
    for (const std::uint32_t t : triangles_of_.row(v)) {
      worst = std::min(worst, quality(t, v, p));
      if (worst <= bound) break;
    }
    return worst;
  }
  bool would_invert(std::uint32_t v, Vec3 p) {
    for (const std::uint32_t t : triangles_of_.row(v)) {
      const Triangle& c = triangles_[t];
      const std::array<Vec3, 3> q{c[0] == v ? p : points_[c[0]], c[1] == v ? p : points_[c[1]],
                                  c[2] == v ? p : points_[c[2]]};
      if (dot(face_direction_at_start(t), cross(q[1] - q[0], q[2] - q[0])) < 0) return true;
    }
    return false;
  }
  // Upper bound of the distance from the surface: the distance of a point found by following the
  // gradient; infinite if none is found.
  double distance_to_surface(Vec3 p) const {
    if (field_ == nullptr) return 0;
    Vec3 q = p;
    for (int step = 0; step < kNewtonSteps; ++step) {
      const InterpolatedField::Value f =
          field_->at({q.x / spacing_.x, q.y / spacing_.y, q.z / spacing_.z});
      const Vec3 gradient{f.gradient.x / spacing_.x, f.gradient.y / spacing_.y,
                          f.gradient.z / spacing_.z};
      const double slope = length(gradient);
      if (f.value == 0) return length(q - p);
      const double offset = f.value / slope;
      if (!std::isfinite(offset) || std::abs(offset) > 1) break;
      if (std::abs(offset) < kOnSurface) return length(q - p) + std::abs(offset);
      q = q - offset / slope * gradient;
    }
    return INFINITY;
  }
  // Tries the directions to the corners, edges and faces of a cube.
  bool improve(std::uint32_t v, double step) {
    double best = worst_in_ring(v, points_[v], 0);
    if (best >= 1) return false;
    const double farthest = std::max(kMaxFinalOffset, distance_to_surface(points_[v]));
    const MoveBounds bounds_of = bounds_of_(v);
    const Vec3 from = points_[v];
    Vec3 found = from;
    for (int k = 0; k < 27; ++k) {
      const Vec3 d{k % 3 - 1.0, k / 3 % 3 - 1.0, k / 9 - 1.0};
      const double l = length(d);
      if (l == 0) continue;
      const Vec3 p = clamped(from + (step / l) * d, bounds_of);
      if (p == from) continue;
      const double worst = worst_in_ring(v, p, best + kMinRelaxationGain);
      if (worst <= best + kMinRelaxationGain || would_invert(v, p) ||
          distance_to_surface(p) > farthest)
        continue;
      best = worst;
      found = p;
    }
    if (found == from) return false;
    points_[v] = found;
    return true;
  }

  // Reverts components that enclose nearly nothing, since they might become inverted. The volume of
  // an open component has no meaning here.
  void revert_flattened_components() {
    control_.check_cancelled();
    if (ranges::all_of(touched_, [&](std::uint32_t v) { return points_[v] == start_[v]; })) return;
    const auto n = static_cast<std::uint32_t>(points_.size());
    DisjointSets sets(n);
    for_each_index(triangles_.size(), kTrianglesPerChunk, &control_, [&](std::size_t t) {
      sets.unite(triangles_[t][0], triangles_[t][1]);
      sets.unite(triangles_[t][0], triangles_[t][2]);
    });
    struct Shape {
      double before = 0, after = 0;  // six times the volume
      Vec3 area;                     // the sum is zero for a closed component
      double size = 0;
    };
    std::vector<Shape> shapes(n);  // per root of `sets`
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      poll_.step();
      const Triangle& c = triangles_[t];
      const std::uint32_t root = sets.find(c[0]);
      const auto volume =
          [&](std::span<const Vec3> at) {  // relative to the first vertex, to reduce rounding
            return dot(at[c[0]] - start_[root],
                       cross(at[c[1]] - start_[root], at[c[2]] - start_[root]));
          };
      Shape& shape = shapes[root];
      const Vec3 a = area(t, start_);
      shape.before += volume(start_);
      shape.after += volume(points_);
      shape.area = shape.area + a;
      shape.size += length(a);
    }
    for (const std::uint32_t v : touched_) {
      const Shape& shape = shapes[sets.find(v)];
      const bool is_open = length(shape.area) > kClosedTolerance * shape.size;
      if (!is_open && shape.after * shape.before < kMinVolumeShare * shape.before * shape.before)
        points_[v] = start_[v];
    }
  }

  const RunControl& control_;
  CancelPoll poll_;  // for loops that are not parallel
  std::span<const std::uint32_t> candidates_;
  std::span<Vec3> points_;
  std::span<const Triangle> triangles_;
  const std::function<MoveBounds(std::uint32_t)>& bounds_of_;
  const InterpolatedField* field_;
  Vec3 spacing_;
  RelaxGoal goal_;
  const SlackRows<std::uint32_t>& triangles_of_;
  static constexpr std::uint32_t kUnknown = kNone - 1;
  mutable std::vector<std::array<std::uint32_t, 3>> opposite_;
  std::vector<Vec3> start_;
  std::vector<std::uint32_t> active_, pushed_;  // triangles, vertices
  std::vector<Vec3> push_;                      // per vertex
  std::vector<std::uint32_t> pushes_;           // per vertex
  std::vector<std::uint32_t> touched_;    // vertices that were moved; some may have been reverted
  std::vector<std::uint8_t> is_touched_;  // per vertex
  std::vector<Vec3> face_directions_;     // per triangle, at the start, if known
  std::vector<std::uint8_t> is_face_direction_known_;  // per triangle
  std::vector<std::uint8_t> seen_;                     // per triangle
  std::vector<std::uint32_t> round_;  // per vertex that is to be improved, its round; 0: not yet
                                      // assigned, or not to be improved
};

}  // namespace

MoveBounds move_bounds_of(Vec3 position, Vec3 spacing) {
  const auto low = [](double x) {
    return x == std::floor(x) ? x : std::min(x, std::floor(x) + kWallMargin);
  };
  const auto high = [](double x) {
    return x == std::floor(x) ? x : std::max(x, std::floor(x) + 1 - kWallMargin);
  };
  return {to_metric({low(position.x), low(position.y), low(position.z)}, spacing),
          to_metric({high(position.x), high(position.y), high(position.z)}, spacing)};
}

std::vector<std::uint32_t> relax(std::span<Vec3> points, std::span<const Triangle> triangles,
                                 const SlackRows<std::uint32_t>& triangles_of,
                                 const std::function<MoveBounds(std::uint32_t)>& bounds_of,
                                 const InterpolatedField* field, Vec3 spacing,
                                 const RelaxGoal& goal, const RunControl& control,
                                 std::span<const std::uint32_t> candidates) {
  return Relaxation(points, triangles, triangles_of, bounds_of, field, spacing, goal, control,
                    candidates)
      .run();
}

}  // namespace isoatlas::detail
