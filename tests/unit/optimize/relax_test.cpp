// SPDX-License-Identifier: Apache-2.0
#include "optimize/relax.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "core/vector_math.h"
#include "isoatlas/error.h"
#include "optimize/face_direction.h"
#include "support/exact_volume.h"

namespace isoatlas::detail {
namespace {

using namespace test;

constexpr double kFar = 1e3;
constexpr MoveBounds kAnywhere{{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};

struct Mesh {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;

  SlackRows<std::uint32_t> triangles_of() const {
    SlackRows<std::uint32_t> out;
    out.add_rows(points.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      for (const std::uint32_t v : triangles[t]) out.push_back(v, t);
    }
    return out;
  }
  std::vector<std::uint32_t> all_triangles() const {
    std::vector<std::uint32_t> out(triangles.size());
    std::iota(out.begin(), out.end(), 0u);
    return out;
  }
  std::array<double, 3> edges(std::uint32_t t) const {
    const Triangle& c = triangles[t];
    return {length(points[c[1]] - points[c[0]]), length(points[c[2]] - points[c[1]]),
            length(points[c[0]] - points[c[2]])};
  }
  double aspect(std::uint32_t t) const {
    const auto e = edges(t);
    return *std::min_element(e.begin(), e.end()) / *std::max_element(e.begin(), e.end());
  }
  Vec3 area(std::uint32_t t) const {
    const Triangle& c = triangles[t];
    return cross(points[c[1]] - points[c[0]], points[c[2]] - points[c[0]]);
  }
};

using Bounds = std::function<MoveBounds(std::uint32_t)>;

std::vector<std::uint32_t> relax_all(Mesh& mesh, const Bounds& bounds, const RelaxGoal& goal,
                                     const InterpolatedField* field = nullptr,
                                     Vec3 spacing = {1, 1, 1}) {
  return relax(mesh.points, mesh.triangles, mesh.triangles_of(), bounds, field, spacing, goal, {},
               mesh.all_triangles());
}

Bounds anywhere_except(std::vector<std::uint32_t> fixed, const Mesh& mesh) {
  return [fixed = std::move(fixed), start = mesh.points](std::uint32_t v) {
    return std::find(fixed.begin(), fixed.end(), v) == fixed.end() ? kAnywhere
                                                                   : MoveBounds{start[v], start[v]};
  };
}

// n x m vertices, with random displacements of up to `jitter` along each axis.
Mesh jittered_grid(std::uint32_t n, std::uint32_t m, Vec3 jitter, Random& random) {
  Mesh out;
  const auto any = [&](double most) { return most * (2 * random.unit() - 1); };
  for (std::uint32_t y = 0; y < m; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const Vec3 d{any(jitter.x), any(jitter.y), any(jitter.z)};
      out.points.push_back(Vec3{static_cast<double>(x), static_cast<double>(y), 0} + d);
    }
  }
  for (std::uint32_t y = 0; y + 1 < m; ++y) {
    for (std::uint32_t x = 0; x + 1 < n; ++x) {
      const std::uint32_t a = x + n * y, b = a + 1, c = b + n, d = a + n;
      out.triangles.push_back({a, b, c});
      out.triangles.push_back({a, c, d});
    }
  }
  return out;
}

// Boxes of a size of 1 about the vertices; about one vertex of five is fixed.
std::vector<MoveBounds> random_boxes(const Mesh& mesh, Random& random) {
  std::vector<MoveBounds> out;
  for (const Vec3 p : mesh.points) {
    const Vec3 half = random.between(0, 4) == 0 ? Vec3{} : Vec3{0.5, 0.5, 0.5};
    out.push_back({p - half, p + half});
  }
  return out;
}

TEST(MoveBoundsOf, IsTheShrunkGridCell) {
  const MoveBounds b = move_bounds_of({0.5, 3.25, -1.5}, {1, 2, 4});
  EXPECT_EQ(b.low, (Vec3{kWallMargin, 2 * (3 + kWallMargin), 4 * (-2 + kWallMargin)}));
  EXPECT_EQ(b.high, (Vec3{1 - kWallMargin, 2 * (4 - kWallMargin), 4 * (-1 - kWallMargin)}));
}

TEST(MoveBoundsOf, KeepsWallsAndPointsNearThem) {
  const MoveBounds b = move_bounds_of({2, 0.01, 5.99}, {1, 1, 1});
  EXPECT_EQ(b.low, (Vec3{2, 0.01, 5 + kWallMargin})) << "on a wall in x, near one in y";
  EXPECT_EQ(b.high, (Vec3{2, 1 - kWallMargin, 5.99}));
  const MoveBounds corner = move_bounds_of({1, 2, 3}, {1, 2, 3});
  EXPECT_EQ(corner.low, (Vec3{1, 4, 9}));
  EXPECT_EQ(corner.high, corner.low) << "fixed";
}

TEST(Relax, ChangesNothingWithoutCandidates) {
  Mesh empty;
  EXPECT_TRUE(relax_all(empty, [](std::uint32_t) { return kAnywhere; }, {0.5, 1}).empty());
  Mesh bad{{{0, 0, 0}, {0.1, 0, 0}, {0, 5, 0}}, {{0, 1, 2}}};
  const std::vector<Vec3> start = bad.points;
  EXPECT_TRUE(relax(bad.points, bad.triangles, bad.triangles_of(),
                    [](std::uint32_t) { return kAnywhere; }, nullptr, {1, 1, 1}, {0.5, 1}, {}, {})
                  .empty());
  EXPECT_EQ(bad.points, start);
}

// Pushing aims at 1.12 times the goal, but triangles that reach the goal are not changed.
TEST(Relax, ChangesNoTriangleThatReachesTheGoal) {
  Mesh mesh{{{0, 0, 0}, {4, 0, 0}, {0, 3, 0}}, {{0, 1, 2}}};  // 3-4-5: an aspect of 0.6
  const std::vector<Vec3> start = mesh.points;
  EXPECT_TRUE(relax_all(mesh, [](std::uint32_t) { return kAnywhere; }, {0.6, 3}).empty());
  EXPECT_EQ(mesh.points, start);
  EXPECT_FALSE(relax_all(mesh, [](std::uint32_t) { return kAnywhere; }, {0.61, 0}).empty());
  mesh.points = start;
  EXPECT_FALSE(relax_all(mesh, [](std::uint32_t) { return kAnywhere; }, {0, 3.01}).empty());
}

// A push adds 0.6 of what the edge lacks of 1.02 times the goal, so after n pushes it lacks 0.4^n
// of what it lacked first. The edge reaches the goal with the fourth push.
TEST(Relax, PushesTheEndsOfAShortEdgeApart) {
  const Mesh start{{{0, 0, 0}, {0.5, 0, 0}, {0.25, 10, 0}}, {{0, 1, 2}}};
  const double edge = 1.02 - 0.52 * std::pow(0.4, 4), missing = edge - 0.5;
  Mesh mesh = start;
  EXPECT_EQ(relax_all(mesh, anywhere_except({2}, mesh), {0, 1}),
            (std::vector<std::uint32_t>{0, 1}));
  EXPECT_NEAR(mesh.points[0].x, -missing / 2, 1e-12);
  EXPECT_NEAR(mesh.points[1].x, 0.5 + missing / 2, 1e-12);
  EXPECT_EQ(mesh.points[2], start.points[2]);
  mesh = start;
  EXPECT_EQ(relax_all(mesh, anywhere_except({0, 2}, mesh), {0, 1}),
            (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(mesh.points[0], start.points[0]);
  EXPECT_NEAR(mesh.points[1].x, edge, 1e-12) << "the whole length";
  mesh = start;
  EXPECT_TRUE(relax_all(mesh, anywhere_except({0, 1, 2}, mesh), {0, 1}).empty());
  EXPECT_EQ(mesh.points, start.points);
}

// Ends without a direction are pushed along x, the vertex with the smaller id to the left: in both
// triangles of the edge the same.
TEST(Relax, SeparatesCoincidentVertices) {
  Mesh mesh{{{0, 0, 0}, {0, 0, 0}, {0, 10, 0}, {0, -10, 0}}, {{0, 1, 2}, {1, 0, 3}}};
  EXPECT_EQ(relax_all(mesh, anywhere_except({2, 3}, mesh), {0, 1}),
            (std::vector<std::uint32_t>{0, 1}));
  const double edge = 1.02 * (1 - std::pow(0.4, 5));
  EXPECT_NEAR(mesh.points[0].x, -edge / 2, 1e-12);
  EXPECT_NEAR(mesh.points[1].x, edge / 2, 1e-12);
}

TEST(Relax, KeepsVerticesInTheirBoxes) {
  Mesh mesh{{{0, 0, 0}, {0.5, 0, 0}, {0.25, 10, 0}}, {{0, 1, 2}}};
  const Vec3 end = mesh.points[2];
  relax_all(mesh,
            [&](std::uint32_t v) {
              return v == 0   ? MoveBounds{{-0.125, 0, 0}, {0.125, 0, 0}}
                     : v == 1 ? MoveBounds{{0.25, 0, 0}, {0.625, 0, 0}}
                              : MoveBounds{end, end};
            },
            {0, 1});
  EXPECT_EQ(mesh.points[0], (Vec3{-0.125, 0, 0})) << "as far as its box allows";
  EXPECT_EQ(mesh.points[1], (Vec3{0.625, 0, 0}));
}

// A needle of a base and a tip. The tip is pulled to the base, unless the surface is closed and
// would enclose less than a quarter of its volume.
TEST(Relax, RevertsAClosedComponentThatIsFlattened) {
  const double h = std::sqrt(0.75);
  const Mesh open{{{0, 0, 0}, {1, 0, 0}, {0.5, h, 0}, {0.5, h / 3, 20}},
                  {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  const RelaxGoal goal{0.6, 0};
  Mesh mesh = open;
  EXPECT_EQ(relax_all(mesh, anywhere_except({0, 1, 2}, mesh), goal),
            (std::vector<std::uint32_t>{3}));
  EXPECT_LT(mesh.points[3].z, 5);
  EXPECT_GT(mesh.points[3].z, 0);
  mesh = open;
  mesh.triangles.push_back({0, 2, 1});
  // A second closed component beside it may change.
  for (const Vec3 p : open.points) mesh.points.push_back(p + Vec3{40, 0, 0});
  mesh.points[7].z = 2.6;
  for (int t = 0; t < 4; ++t) {
    const Triangle c = mesh.triangles[t];
    mesh.triangles.push_back({c[0] + 4, c[1] + 4, c[2] + 4});
  }
  const std::vector<Vec3> start = mesh.points;
  EXPECT_EQ(relax_all(mesh, anywhere_except({0, 1, 2, 4, 5, 6}, mesh), goal),
            (std::vector<std::uint32_t>{7}));
  EXPECT_EQ(mesh.points[3], start[3]);
  EXPECT_LT(mesh.points[7].z, start[7].z);
  EXPECT_GT(mesh.points[7].z, start[7].z / 4);
}

TEST(Relax, StopsWhenCancelled) {
  Mesh mesh{{{0, 0, 0}, {0.5, 0, 0}, {0.25, 10, 0}}, {{0, 1, 2}}};
  const std::atomic<bool> cancel = true;
  RunControl control;
  control.cancel = &cancel;
  try {
    relax(
        mesh.points, mesh.triangles, mesh.triangles_of(), [](std::uint32_t) { return kAnywhere; },
        nullptr, {1, 1, 1}, {0.5, 0}, control, mesh.all_triangles());
    FAIL() << "not cancelled";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
}

// A tilted plane, which a trilinear field contains exactly, so that distances are known.
struct Plane {
  explicit Plane(Vec3 spacing_of_volume)
      : spacing(spacing_of_volume),
        volume(exact_volume({20, 14, 12},
                            [this](double x, double y, double z) {
                              return height({x * spacing.x, y * spacing.y, z * spacing.z});
                            })),
        field(volume.view, {0, Inside::above, NonFinite::refuse}) {}
  /// Signed distance of a metric point.
  double height(Vec3 p) const { return dot(normal, p - origin); }
  /// The point above (x, y) of the plane's own axes.
  Vec3 at(Vec3 p) const {
    const Vec3 u = normalized(cross({0, 1, 0}, normal)), v = cross(normal, u);
    return origin + p.x * u + p.y * v + p.z * normal;
  }

  Vec3 spacing;
  Vec3 normal = normalized(Vec3{0.1, -0.2, 1});
  Vec3 origin{4, 3, 5};
  Volume volume;
  InterpolatedField field;
};

// The box has no extent across x, so a push along the slope leaves the surface, and pulling cannot
// return all the way.
TEST(Relax, StaysNearASurfaceThatIsOblique) {
  const Volume volume =
      exact_volume({12, 8, 12}, [](double x, double, double z) { return 10 - x - z; });
  const InterpolatedField field(volume.view, {0, Inside::above, NonFinite::refuse});
  Mesh mesh{{{4, 3, 6}, {4.1, 3, 5.9}, {4, 5, 6}}, {{0, 1, 2}}};
  const std::vector<Vec3> start = mesh.points;
  const std::vector<std::uint32_t> moved = relax_all(
      mesh,
      [&](std::uint32_t v) {
        return v == 1 ? MoveBounds{{2, 3, 5.9}, {9, 3, 5.9}} : MoveBounds{start[v], start[v]};
      },
      {0, 3}, &field);
  EXPECT_EQ(moved, (std::vector<std::uint32_t>{1}));
  EXPECT_LE((mesh.points[1].x - 4.1) / std::sqrt(2.0), 0.4);
  EXPECT_GT((mesh.points[1].x - 4.1) / std::sqrt(2.0), 0.3);
}

TEST(Relax, KeepsItsPromisesForRandomMeshes) {
  std::size_t bad_before = 0, bad_after = 0, moved_count = 0, far_before = 0;
  std::vector<std::uint64_t> seeds(120);
  std::iota(seeds.begin(), seeds.end(), 0u);
  seeds.push_back(1028);  // reverting an inverted triangle inverts one that was checked before
  for (const std::uint64_t seed : seeds) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Plane plane(seed % 2 == 0 ? Vec3{1, 1, 1} : Vec3{1, 1.5, 2});
    Mesh mesh = jittered_grid(9, 8, {0.48, 0.48, seed % 4 < 2 ? 0.1 : 0.5}, random);
    for (Vec3& p : mesh.points) p = plane.at(p);
    const std::vector<MoveBounds> boxes = random_boxes(mesh, random);
    const RelaxGoal goal{0.3 + 0.5 * random.unit(), seed % 3 == 0 ? 0.9 : 0, seed % 5 != 0};
    const Mesh before = mesh;
    const std::vector<std::uint32_t> moved = relax_all(
        mesh, [&](std::uint32_t v) { return boxes[v]; }, goal, &plane.field, plane.spacing);
    ASSERT_TRUE(std::is_sorted(moved.begin(), moved.end()));
    ASSERT_EQ(std::adjacent_find(moved.begin(), moved.end()), moved.end());
    moved_count += moved.size();
    for (std::uint32_t v = 0; v < mesh.points.size(); ++v) {
      const Vec3 p = mesh.points[v];
      ASSERT_EQ(std::binary_search(moved.begin(), moved.end(), v), !(p == before.points[v])) << v;
      ASSERT_TRUE(boxes[v].low.x <= p.x && p.x <= boxes[v].high.x);
      ASSERT_TRUE(boxes[v].low.y <= p.y && p.y <= boxes[v].high.y);
      ASSERT_TRUE(boxes[v].low.z <= p.z && p.z <= boxes[v].high.z);
      const double was = std::abs(plane.height(before.points[v]));
      far_before += was > 0.4;
      ASSERT_LE(std::abs(plane.height(p)), std::max(0.4, was) + 1e-9) << v;
    }
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const Vec3 facing_before = face_direction(
          t,
          [&](std::uint32_t i) {
            const Triangle& c = before.triangles[i];
            return std::array{before.points[c[0]], before.points[c[1]], before.points[c[2]]};
          },
          [&](auto add) {
            for (const std::uint32_t v : before.triangles[t]) {
              for (std::uint32_t i = 0; i < before.triangles.size(); ++i) {
                if (std::count(before.triangles[i].begin(), before.triangles[i].end(), v)) add(i);
              }
            }
          });
      // An inverted sliver of the input may stay as it was.
      if (!(mesh.area(t) == before.area(t))) {
        ASSERT_GE(dot(facing_before, mesh.area(t)), 0) << "triangle " << t;
      }
      bad_before += before.aspect(t) < goal.aspect;
      bad_after += mesh.aspect(t) < goal.aspect;
    }
  }
  EXPECT_GT(moved_count, 1500u);
  EXPECT_GT(far_before, 60u);
  EXPECT_LT(2 * bad_after, bad_before);
}

// The second of two components is well shaped.
TEST(Relax, ChangesOnlyBadlyShapedPlaces) {
  Random random(1);
  Mesh mesh = jittered_grid(8, 8, {0.4, 0.4, 0.1}, random);
  const auto n = static_cast<std::uint32_t>(mesh.points.size());
  const Mesh good = jittered_grid(8, 8, {}, random);
  for (const Vec3 p : good.points) mesh.points.push_back(p + Vec3{20, 0, 0});
  for (const Triangle& t : good.triangles) mesh.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  const std::vector<std::uint32_t> moved =
      relax_all(mesh, [](std::uint32_t) { return kAnywhere; }, {0.65, 0});
  ASSERT_FALSE(moved.empty());
  EXPECT_LT(moved.back(), n);
}

// The search one vertex after the other, in increasing order, without any cache.
class SlowSearch {
 public:
  SlowSearch(Mesh& mesh, const std::vector<MoveBounds>& boxes, const RelaxGoal& goal)
      : mesh_(mesh), start_(mesh), boxes_(boxes), goal_(goal), triangles_of_(mesh.triangles_of()) {}

  void run() {
    for (const double step : {0.2, 0.05}) {
      std::vector<std::uint32_t> next;
      for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) add_corners_if_bad(t, next);
      for (int pass = 0; pass < 4; ++pass) {
        const std::vector<std::uint32_t> now = std::exchange(next, {});
        for (std::uint32_t v = 0; v < mesh_.points.size(); ++v) {
          if (std::count(now.begin(), now.end(), v) == 0 || !improve(v, step)) continue;
          next.push_back(v);
          for (const std::uint32_t t : triangles_of_.row(v)) add_corners_if_bad(t, next);
        }
      }
    }
  }

 private:
  void add_corners_if_bad(std::uint32_t t, std::vector<std::uint32_t>& out) const {
    if (quality(t) < 1) out.insert(out.end(), mesh_.triangles[t].begin(), mesh_.triangles[t].end());
  }
  // The corner opposite to the side from a to b of another triangle, which has it from b to a.
  Vec3 opposite(std::uint32_t a, std::uint32_t b, Vec3 otherwise) const {
    for (const std::uint32_t t : triangles_of_.row(a)) {
      const Triangle& c = mesh_.triangles[t];
      for (int k = 0; k < 3; ++k) {
        if (c[k] == b && c[(k + 1) % 3] == a) return mesh_.points[c[(k + 2) % 3]];
      }
    }
    return otherwise;
  }
  double quality(std::uint32_t t) const {
    const std::array<double, 3> e = mesh_.edges(t);
    double closest = *std::min_element(e.begin(), e.end());
    const double aspect = mesh_.aspect(t) / (1.01 * goal_.aspect);
    const Triangle& c = mesh_.triangles[t];
    for (int k = 0; k < 3; ++k) {
      const Vec3 far = mesh_.points[c[k]] + Vec3{kFar, 0, 0};
      closest = std::min(
          closest, length(opposite(c[(k + 1) % 3], c[(k + 2) % 3], far) - mesh_.points[c[k]]));
    }
    return std::min({1.0, aspect, 0.5 + 0.5 * closest / goal_.separation});
  }
  double worst_in_ring(std::uint32_t v) const {
    double worst = 1;
    for (const std::uint32_t t : triangles_of_.row(v)) worst = std::min(worst, quality(t));
    return worst;
  }
  bool is_inverted(std::uint32_t t) const {
    const Vec3 was = face_direction(
        t,
        [&](std::uint32_t i) {
          const Triangle& c = start_.triangles[i];
          return std::array{start_.points[c[0]], start_.points[c[1]], start_.points[c[2]]};
        },
        [&](auto add) {
          for (const std::uint32_t v : start_.triangles[t]) {
            for (const std::uint32_t i : triangles_of_.row(v)) add(i);
          }
        });
    return dot(was, mesh_.area(t)) < 0;
  }
  bool improve(std::uint32_t v, double step) {
    const Vec3 from = mesh_.points[v];
    const MoveBounds& box = boxes_[v];
    if (box.low == box.high) return false;
    double best = worst_in_ring(v);
    if (best >= 1) return false;
    Vec3 found = from;
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          if (x == 0 && y == 0 && z == 0) continue;
          const double l = step / std::sqrt(x * x + y * y + z * z);
          mesh_.points[v] = {std::clamp(from.x + l * x, box.low.x, box.high.x),
                             std::clamp(from.y + l * y, box.low.y, box.high.y),
                             std::clamp(from.z + l * z, box.low.z, box.high.z)};
          const double worst = worst_in_ring(v);
          bool inverted = false;
          for (const std::uint32_t t : triangles_of_.row(v)) inverted = inverted || is_inverted(t);
          if (worst <= best + 2e-3 || inverted) continue;
          best = worst;
          found = mesh_.points[v];
        }
      }
    }
    mesh_.points[v] = found;
    return !(found == from);
  }

  Mesh& mesh_;
  const Mesh start_;
  const std::vector<MoveBounds>& boxes_;
  RelaxGoal goal_;
  SlackRows<std::uint32_t> triangles_of_;
};

TEST(Relax, SearchEqualsOneVertexAfterTheOther) {
  Random random(3);
  Mesh mesh = jittered_grid(30, 28, {0.45, 0.45, 0.3}, random);
  const std::vector<MoveBounds> boxes = random_boxes(mesh, random);
  const RelaxGoal goal{0.5, 0.6, false};
  Mesh slow = mesh;
  SlowSearch(slow, boxes, goal).run();
  const std::vector<std::uint32_t> moved = relax_all(
      mesh, [&](std::uint32_t v) { return boxes[v]; }, goal);
  EXPECT_GT(moved.size(), 200u);
  for (std::uint32_t v = 0; v < mesh.points.size(); ++v)
    ASSERT_LT(length(mesh.points[v] - slow.points[v]), 1e-9) << v;
}

TEST(Relax, DoesNotDependOnTheNumberOfThreads) {
  Random random(4);
  const Mesh start = jittered_grid(60, 60, {0.45, 0.45, 0.3}, random);
  const std::vector<MoveBounds> boxes = random_boxes(start, random);
  std::vector<std::uint32_t> moved_first;
  Mesh first;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    Mesh mesh = start;
    const std::vector<std::uint32_t> moved =
        relax_all(mesh, [&](std::uint32_t v) { return boxes[v]; }, {0.5, 0.6});
    if (threads == 1) {
      first = mesh;
      moved_first = moved;
    }
    ASSERT_EQ(moved, moved_first) << threads;
    ASSERT_EQ(mesh.points, first.points) << threads;
  }
  EXPECT_GT(moved_first.size(), 1000u);
}

}  // namespace
}  // namespace isoatlas::detail
