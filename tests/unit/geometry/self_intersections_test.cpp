// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/self_intersections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "exact_triangles.h"
#include "geometry/triangle_pair.h"
#include "isoatlas/error.h"
#include "support/mesh_reference.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using test::LatticePoint;
using test::Random;

std::vector<TrianglePair> pairs_of(const TriangleMesh& mesh,
                                   const SelfIntersectionOptions& options = {}, int threads = 0) {
  RunControl control;
  control.threads = threads;
  return self_intersections(mesh.positions, mesh.triangles, options, control);
}

// Triangles of all sizes among few lattice points, so that corners are shared, positions coincide
// and areas are zero.
struct LatticeSoup {
  std::vector<LatticePoint> points;
  std::vector<Triangle> triangles;
  TriangleMesh mesh(double scale = 1, Vec3 offset = {}) const {
    return {test::to_positions(points, scale, offset), triangles};
  }
};

LatticeSoup random_soup(std::uint64_t seed, std::size_t vertices, std::size_t triangles) {
  Random random(seed);
  LatticeSoup soup;
  for (std::size_t v = 0; v < vertices; ++v)
    soup.points.push_back({random.between(0, 12), random.between(0, 12), random.between(0, 12)});
  const auto distance = [&](std::uint32_t i, std::uint32_t j) {
    std::int64_t sum = 0;
    for (int a = 0; a < 3; ++a) sum += std::abs(soup.points[i][a] - soup.points[j][a]);
    return sum;
  };
  while (soup.triangles.size() < triangles) {
    const auto any = [&] {
      return static_cast<std::uint32_t>(random.between(0, static_cast<std::int64_t>(vertices) - 1));
    };
    const Triangle t{any(), any(), any()};
    const std::int64_t size = std::max(distance(t[0], t[1]), distance(t[0], t[2]));
    if (size < 8 || random.between(0, 30) == 0) soup.triangles.push_back(t);
  }
  return soup;
}

std::vector<TrianglePair> slow_pairs(const LatticeSoup& soup) {
  std::vector<TrianglePair> out;
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i)
    for (std::uint32_t j = i + 1; j < soup.triangles.size(); ++j)
      if (test::slow_intersect_beyond_shared_simplex(soup.points, soup.triangles[i],
                                                     soup.triangles[j]))
        out.emplace_back(i, j);
  return out;
}

// A ball's surface, closed: rings of `n` vertices between two poles.
TriangleMesh ball(std::uint32_t n, Vec3 centre, double radius) {
  TriangleMesh mesh;
  const std::uint32_t rings = n / 2;
  const auto ring_vertex = [&](std::uint32_t ring, std::uint32_t k) {
    return 1 + (ring - 1) * n + k % n;
  };
  const auto add = [&](double polar, double enclosing) {
    mesh.positions.push_back({centre.x + radius * std::sin(polar) * std::cos(enclosing),
                              centre.y + radius * std::sin(polar) * std::sin(enclosing),
                              centre.z + radius * std::cos(polar)});
  };
  add(0, 0);
  for (std::uint32_t ring = 1; ring < rings; ++ring)
    for (std::uint32_t k = 0; k < n; ++k)
      add(std::numbers::pi * ring / rings, 2 * std::numbers::pi * k / n);
  add(std::numbers::pi, 0);
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (std::uint32_t k = 0; k < n; ++k) {
    mesh.triangles.push_back({0, ring_vertex(1, k), ring_vertex(1, k + 1)});
    for (std::uint32_t ring = 1; ring + 1 < rings; ++ring) {
      mesh.triangles.push_back(
          {ring_vertex(ring, k), ring_vertex(ring + 1, k), ring_vertex(ring + 1, k + 1)});
      mesh.triangles.push_back(
          {ring_vertex(ring, k), ring_vertex(ring + 1, k + 1), ring_vertex(ring, k + 1)});
    }
    mesh.triangles.push_back({last, ring_vertex(rings - 1, k + 1), ring_vertex(rings - 1, k)});
  }
  return mesh;
}

TriangleMesh both(TriangleMesh a, const TriangleMesh& b) {
  const auto n = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  return a;
}

TEST(SelfIntersections, EmptyMeshHasNone) {
  EXPECT_TRUE(self_intersections({}, {}).empty());
  EXPECT_TRUE(pairs_of({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}).empty());
  EXPECT_TRUE(pairs_of({{{0, 0, 0}}, {}}).empty());
}

TEST(SelfIntersections, ABallHasNone) { EXPECT_TRUE(pairs_of(ball(60, {1, 2, 3}, 7)).empty()); }

TEST(SelfIntersections, NestedBallsHaveNone) {
  EXPECT_TRUE(pairs_of(both(ball(40, {0, 0, 0}, 1), ball(40, {0, 0, 0}, 1 + 0x1p-30))).empty());
}

TEST(SelfIntersections, CrossingBallsIntersectAlongACircle) {
  const TriangleMesh mesh = both(ball(60, {0, 0, 0}, 1), ball(60, {0.9, 0.3, 0.2}, 1));
  const std::vector<TrianglePair> pairs = pairs_of(mesh);
  EXPECT_GT(pairs.size(), 100u);
  for (const auto& [a, b] : pairs) {
    EXPECT_LT(a, mesh.triangles.size() / 2);
    EXPECT_GE(b, mesh.triangles.size() / 2);
  }
}

TEST(SelfIntersections, AgreesWithAllPairsOfIntegers) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const LatticeSoup soup = random_soup(seed, 10 + 10 * seed, 20 * seed);
    const std::vector<TrianglePair> wanted = slow_pairs(soup);
    EXPECT_FALSE(wanted.empty());
    ASSERT_EQ(pairs_of(soup.mesh()), wanted) << seed;
    // Wide boxes in single precision only cost time.
    ASSERT_EQ(pairs_of(soup.mesh(0x1p-30, {1000, 1000, 1000})), wanted) << seed;
    ASSERT_EQ(pairs_of(soup.mesh(0x1p-1074)), wanted) << seed;
    ASSERT_EQ(pairs_of(soup.mesh(0x1p1019)), wanted) << seed;
  }
}

TEST(SelfIntersections, SizesFarApart) {
  TriangleMesh mesh = random_soup(3, 100, 200).mesh(0x1p-60);
  const std::vector<TrianglePair> wanted = pairs_of(mesh);
  mesh.positions.push_back({1e300, 1e300, 1e300});  // in no triangle
  EXPECT_EQ(pairs_of(mesh), wanted);
}

TEST(SelfIntersections, FollowsAPermutation) {
  const LatticeSoup soup = random_soup(11, 150, 400);
  TriangleMesh mesh = soup.mesh();
  const std::vector<TrianglePair> wanted = pairs_of(mesh);
  Random random(5);
  const auto shuffled = [&](std::size_t n) {
    std::vector<std::uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0u);
    for (std::size_t i = n; i > 1; --i)
      std::swap(order[i - 1], order[random.between(0, static_cast<std::int64_t>(i) - 1)]);
    return order;
  };
  const std::vector<std::uint32_t> vertex = shuffled(mesh.positions.size()),
                                   place = shuffled(mesh.triangles.size());
  TriangleMesh other = mesh;
  for (std::size_t v = 0; v < vertex.size(); ++v) other.positions[vertex[v]] = mesh.positions[v];
  for (std::size_t t = 0; t < place.size(); ++t) {
    const Triangle& old = mesh.triangles[t];
    const std::uint32_t turn = static_cast<std::uint32_t>(random.between(0, 2));
    for (std::uint32_t k = 0; k < 3; ++k)
      other.triangles[place[t]][k] = vertex[old[(k + turn) % 3]];
  }
  std::vector<TrianglePair> moved;
  for (const auto& [a, b] : wanted) moved.push_back(std::minmax(place[a], place[b]));
  std::sort(moved.begin(), moved.end());
  EXPECT_EQ(pairs_of(other), moved);
}

TEST(SelfIntersections, SamePairsForAnyNumberOfThreads) {
  const TriangleMesh mesh = both(ball(150, {0, 0, 0}, 1), ball(150, {0.9, 0.3, 0.2}, 1));
  const std::vector<TrianglePair> wanted = pairs_of(mesh, {}, 1);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(pairs_of(mesh, {}, threads), wanted) << threads;
}

TEST(SelfIntersections, InvolvingAListSelectsFromAllPairs) {
  const TriangleMesh mesh = random_soup(7, 200, 600).mesh();
  const std::vector<TrianglePair> all = pairs_of(mesh);
  Random random(2);
  for (const std::size_t length : {0, 1, 5, 100, 600}) {
    std::vector<std::uint32_t> list;  // some of them twice
    for (std::size_t i = 0; i < length; ++i)
      list.push_back(static_cast<std::uint32_t>(random.between(0, 599)));
    std::vector<TrianglePair> wanted;
    for (const auto& [a, b] : all)
      if (std::find(list.begin(), list.end(), a) != list.end() ||
          std::find(list.begin(), list.end(), b) != list.end())
        wanted.emplace_back(a, b);
    EXPECT_EQ(pairs_of(mesh, {.involving = list}), wanted) << length;
  }
  std::vector<std::uint32_t> every(600);
  std::iota(every.begin(), every.end(), 0u);
  EXPECT_EQ(pairs_of(mesh, {.involving = every}), all);
}

TEST(SelfIntersections, RefusesInvalidMeshes) {
  const auto refused = [](const TriangleMesh& mesh, const SelfIntersectionOptions& options,
                          const std::string& part) {
    try {
      pairs_of(mesh, options);
      ADD_FAILURE() << "not refused: " << part;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_argument);
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  const TriangleMesh good{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  TriangleMesh bad = good;
  bad.triangles[0][1] = 3;
  refused(bad, {}, "triangle 0 uses vertex 3, but there are only 3");
  bad = good;
  bad.positions[1].y = std::numeric_limits<double>::quiet_NaN();
  refused(bad, {}, "vertex 1 is not finite");
  bad.positions[1].y = -INFINITY;
  refused(bad, {}, "vertex 1 is not finite");
  const std::vector<std::uint32_t> list{1};
  refused(good, {.involving = list}, "the list has triangle 1, but there are only 1");
}

TEST(SelfIntersections, IntersectionPlaceIsInBothBoxes) {
  const std::vector<Vec3> positions{{0, 0, 0},  {4, 0, 0}, {0, 4, 0},
                                    {1, 1, -1}, {2, 1, 3}, {9, 3, 0}};
  const Vec3 at = intersection_position(positions, {0, 1, 2}, {3, 4, 5});
  EXPECT_EQ(at.x, 2.5);
  EXPECT_EQ(at.y, 2);
  EXPECT_EQ(at.z, 0);
}

TEST(SelfIntersections, CanBeCancelled) {
  const std::atomic<bool> cancel = true;
  RunControl control;
  control.cancel = &cancel;
  const TriangleMesh mesh = ball(20, {0, 0, 0}, 1);
  EXPECT_THROW(self_intersections(mesh.positions, mesh.triangles, {}, control), Error);
}

// The tests' own reference, which shares nothing with the product, on soups in which most positions
// are special.
TEST(MeshReference, CountsTheSameAsTheProduct) {
  test::Random random(3);
  std::size_t seen = 0, flat = 0;
  for (int round = 0; round < 300; ++round) {
    TriangleMesh mesh;
    const auto at = [&] {
      return static_cast<double>(random.between(0, round % 2 == 0 ? 3 : 1000));
    };
    const double far = round % 3 == 0 ? 6e10 : 0;
    for (int v = 0; v < 14; ++v) mesh.positions.push_back({far + at(), at() - far, at()});
    std::ranges::sort(mesh.positions, {}, [](Vec3 p) { return std::array{p.x, p.y, p.z}; });
    mesh.positions.erase(std::unique(mesh.positions.begin(), mesh.positions.end()),
                         mesh.positions.end());
    const auto last = static_cast<std::int64_t>(mesh.positions.size()) - 1;
    for (int t = 0; t < 10; ++t) {
      const auto corner = [&] { return static_cast<std::uint32_t>(random.between(0, last)); };
      const Triangle triangle{corner(), corner(), corner()};
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
        continue;
      if (!has_area(mesh.positions, triangle)) ++flat;
      mesh.triangles.push_back(triangle);
    }
    std::size_t pairs = 0, without_area = 0;
    for (const Triangle& t : mesh.triangles) without_area += has_area(mesh.positions, t) ? 0 : 1;
    for (const auto& [a, b] : self_intersections(mesh.positions, mesh.triangles))
      pairs +=
          has_area(mesh.positions, mesh.triangles[a]) && has_area(mesh.positions, mesh.triangles[b])
              ? 1
              : 0;
    const test::EmbeddingCheck reference = test::check_embedding(mesh);
    ASSERT_EQ(reference.pairs, pairs) << round;
    ASSERT_EQ(reference.without_area, without_area) << round;
    seen += pairs;
  }
  EXPECT_GT(seen, 1000U);
  EXPECT_GT(flat, 5U);
}

// A cube in a cube, oriented so that there is material between them; then each of them inverted,
// and the inner one outside.
TEST(MeshReference, FindsMisplacedComponents) {
  const auto cubes = [](bool outer_inverted, bool inner_inverted, double inner_at) {
    TriangleMesh mesh;
    const std::array<Triangle, 12> faces{{{0, 2, 1},
                                          {1, 2, 3},
                                          {4, 5, 6},
                                          {5, 7, 6},
                                          {0, 1, 4},
                                          {1, 5, 4},
                                          {2, 6, 3},
                                          {3, 6, 7},
                                          {0, 4, 2},
                                          {2, 4, 6},
                                          {1, 3, 5},
                                          {3, 7, 5}}};
    const auto add = [&](double low, double size, bool inverted) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (unsigned k = 0; k < 8; ++k)
        mesh.positions.push_back(
            {low + size * (k & 1), low + size * (k >> 1 & 1), low + size * (k >> 2 & 1)});
      for (Triangle t : faces) {
        for (std::uint32_t& v : t) v += first;
        if (inverted) std::swap(t[1], t[2]);
        mesh.triangles.push_back(t);
      }
    };
    add(0, 10, outer_inverted);
    add(inner_at, 3, inner_inverted);
    return mesh;
  };
  EXPECT_EQ(test::misplaced_components(cubes(false, true, 4)), 0U);
  EXPECT_EQ(test::misplaced_components(cubes(true, false, 4)), 0U) << "what is inside surrounds it";
  EXPECT_EQ(test::misplaced_components(cubes(false, false, 4)), 1U);
  EXPECT_EQ(test::misplaced_components(cubes(true, true, 4)), 1U);
  EXPECT_EQ(test::misplaced_components(cubes(false, true, 20)), 1U);
  EXPECT_EQ(test::misplaced_components(cubes(false, false, 20)), 0U);
}

}  // namespace
}  // namespace isoatlas::detail
