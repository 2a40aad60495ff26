// SPDX-License-Identifier: Apache-2.0
// mesh_topology on hand-made meshes of known topology.
#include <gtest/gtest.h>

#include "core/ids.h"
#include "isoatlas/error.h"
#include "isoatlas/mesh.h"
#include "support/mesh_counts.h"
#include "support/surfaces.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using test::Random;

TriangleMesh mesh_of(std::size_t vertices, std::vector<Triangle> triangles) {
  TriangleMesh out;
  out.positions.resize(vertices);  // topology does not depend on positions
  out.triangles = std::move(triangles);
  return out;
}

std::vector<Triangle> tetrahedron(std::uint32_t a, std::uint32_t b, std::uint32_t c,
                                  std::uint32_t d) {
  return {{a, c, b}, {a, b, d}, {b, c, d}, {c, a, d}};
}

std::vector<Triangle> operator+(std::vector<Triangle> a, const std::vector<Triangle>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// n quads in a row, closed to a ring: a band of n x 2 vertices. With a twist, a Moebius strip.
std::vector<Triangle> band(std::uint32_t n, bool twisted) {
  std::vector<Triangle> out;
  for (std::uint32_t i = 0; i < n; ++i) {
    std::uint32_t a = 2 * i, b = 2 * i + 1, c = 2 * ((i + 1) % n), d = 2 * ((i + 1) % n) + 1;
    if (twisted && i + 1 == n) std::swap(c, d);
    out.push_back({a, c, b});
    out.push_back({b, c, d});
  }
  return out;
}

// n x m quads closed in both directions.
std::vector<Triangle> torus(std::uint32_t n, std::uint32_t m) {
  std::vector<Triangle> out;
  for (std::uint32_t y = 0; y < m; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = x + n * y, b = (x + 1) % n + n * y,
                          c = (x + 1) % n + n * ((y + 1) % m), d = x + n * ((y + 1) % m);
      out.push_back({a, b, c});
      out.push_back({a, c, d});
    }
  }
  return out;
}

TEST(MeshTopology, Empty) {
  const MeshTopology t = mesh_topology({});
  EXPECT_TRUE(t.is_manifold());
  EXPECT_TRUE(t.components.empty());
  EXPECT_EQ(t.euler_characteristic(), 0);
}

TEST(MeshTopology, Tetrahedron) {
  const MeshTopology t = mesh_topology(mesh_of(4, tetrahedron(0, 1, 2, 3)));
  EXPECT_TRUE(t.is_manifold());
  EXPECT_TRUE(t.is_oriented());
  EXPECT_EQ(t.edges, 6u);
  EXPECT_EQ(t.boundary_edges, 0u);
  EXPECT_EQ(t.components, (std::vector<ComponentTopology>{{2, 0}}));
  EXPECT_EQ(t.genus(), 0);
}

TEST(MeshTopology, Torus) {
  const MeshTopology t = mesh_topology(mesh_of(35, torus(7, 5)));
  EXPECT_TRUE(t.is_manifold());
  EXPECT_TRUE(t.is_oriented());
  EXPECT_EQ(t.components, (std::vector<ComponentTopology>{{0, 0}}));
  EXPECT_EQ(t.genus(), 1);
}

TEST(MeshTopology, DiskAnnulusAndDiskWithTwoHoles) {
  const MeshTopology disk = mesh_topology(mesh_of(4, {{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(disk.components, (std::vector<ComponentTopology>{{1, 1}}));
  EXPECT_EQ(disk.boundary_edges, 4u);
  const MeshTopology annulus = mesh_topology(mesh_of(10, band(5, false)));
  EXPECT_TRUE(annulus.is_manifold() && annulus.is_oriented());
  EXPECT_EQ(annulus.components, (std::vector<ComponentTopology>{{0, 2}}));
  EXPECT_EQ(annulus.genus(), 0);
  // A 6 x 4 grid of quads without two of the inner ones.
  std::vector<Triangle> grid;
  for (std::uint32_t y = 0; y < 4; ++y) {
    for (std::uint32_t x = 0; x < 6; ++x) {
      if (y == 1 && (x == 1 || x == 4)) continue;
      const std::uint32_t a = x + 7 * y;
      grid.push_back({a, a + 1, a + 8});
      grid.push_back({a, a + 8, a + 7});
    }
  }
  const MeshTopology holes = mesh_topology(mesh_of(35, grid));
  EXPECT_TRUE(holes.is_manifold() && holes.is_oriented());
  EXPECT_EQ(holes.components, (std::vector<ComponentTopology>{{-1, 3}}));
  EXPECT_EQ(holes.genus(), 0);
}

TEST(MeshTopology, MoebiusStripCannotBeOriented) {
  const MeshTopology t = mesh_topology(mesh_of(10, band(5, true)));
  EXPECT_TRUE(t.is_manifold());
  EXPECT_FALSE(t.is_oriented());
  EXPECT_EQ(t.components, (std::vector<ComponentTopology>{{0, 1}}));
}

TEST(MeshTopology, TwoTetrahedraSharingAVertex) {
  const MeshTopology t =
      mesh_topology(mesh_of(7, tetrahedron(0, 1, 2, 3) + tetrahedron(3, 4, 5, 6)));
  EXPECT_EQ(t.non_manifold_vertices, 1u);
  EXPECT_EQ(t.non_manifold_edges, 0u);
  EXPECT_FALSE(t.is_manifold());
  EXPECT_EQ(t.components.size(), 1u);
}

TEST(MeshTopology, TwoTetrahedraSharingAnEdge) {
  const MeshTopology t =
      mesh_topology(mesh_of(6, tetrahedron(0, 1, 2, 3) + tetrahedron(2, 3, 4, 5)));
  EXPECT_EQ(t.non_manifold_edges, 1u);
  EXPECT_FALSE(t.is_manifold());
}

TEST(MeshTopology, TwoTrianglesTouchingAtACorner) {
  const MeshTopology t = mesh_topology(mesh_of(5, {{0, 1, 2}, {2, 3, 4}}));
  EXPECT_EQ(t.non_manifold_vertices, 1u);
  EXPECT_EQ(t.components.size(), 1u);
  const MeshTopology apart = mesh_topology(mesh_of(6, {{0, 1, 2}, {3, 4, 5}}));
  EXPECT_TRUE(apart.is_manifold());
  EXPECT_EQ(apart.components, (std::vector<ComponentTopology>{{1, 1}, {1, 1}}));
}

TEST(MeshTopology, ThreeTrianglesOnAnEdge) {
  const MeshTopology t = mesh_topology(mesh_of(5, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));
  EXPECT_EQ(t.non_manifold_edges, 1u);
  EXPECT_FALSE(t.is_manifold());
}

TEST(MeshTopology, DuplicateTriangle) {
  auto triangles = tetrahedron(0, 1, 2, 3);
  triangles.push_back(triangles[1]);
  const MeshTopology t = mesh_topology(mesh_of(4, triangles));
  EXPECT_EQ(t.non_manifold_edges, 3u);
  // Alone, a doubled triangle has two triangles at every edge: manifold edges, but both run the
  // same way.
  const MeshTopology single_corner = mesh_topology(mesh_of(3, {{0, 1, 2}, {0, 1, 2}}));
  EXPECT_EQ(single_corner.inconsistent_edges, 3u);
}

TEST(MeshTopology, FlippedTriangle) {
  auto triangles = tetrahedron(0, 1, 2, 3);
  std::swap(triangles[2][0], triangles[2][1]);
  const MeshTopology t = mesh_topology(mesh_of(4, triangles));
  EXPECT_TRUE(t.is_manifold());
  EXPECT_EQ(t.inconsistent_edges, 3u);
  EXPECT_FALSE(t.is_oriented());
}

TEST(MeshTopology, DegenerateTriangle) {
  const MeshTopology t =
      mesh_topology(mesh_of(4, tetrahedron(0, 1, 2, 3) + std::vector<Triangle>{{1, 1, 2}}));
  EXPECT_EQ(t.degenerate_triangles, 1u);
  EXPECT_FALSE(t.is_manifold());
}

TEST(MeshTopology, UnusedVertices) {
  const MeshTopology t = mesh_topology(mesh_of(7, tetrahedron(1, 2, 4, 5)));
  EXPECT_EQ(t.unused_vertices, 3u);
  EXPECT_EQ(t.component_of_vertex[0], kNone);
  EXPECT_EQ(t.component_of_vertex[1], 0u);
  EXPECT_EQ(t.euler_characteristic(), 2);
}

TEST(MeshTopology, CornerOutOfRange) {
  for (const std::uint32_t corner : {4u, 5u, kNone}) {
    try {
      mesh_topology(mesh_of(4, {{0, 1, corner}}));
      FAIL() << corner;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::bad_argument);
      EXPECT_NE(std::string(e.what()).find(std::to_string(corner)), std::string::npos) << e.what();
    }
  }
}

TEST(MeshTopology, ComponentsAreNumberedBySmallestVertex) {
  const MeshTopology t = mesh_topology(
      mesh_of(14, tetrahedron(9, 8, 7, 2) + band(3, false) + tetrahedron(10, 11, 12, 13)));
  // The band uses 0..5 and shares vertex 2 with the first tetrahedron.
  EXPECT_EQ(t.components.size(), 2u);
  EXPECT_EQ(t.component_of_vertex[9], 0u);
  EXPECT_EQ(t.component_of_vertex[13], 1u);
  EXPECT_EQ(t.component_of_vertex[6], kNone);
  EXPECT_EQ(t.components[1], (ComponentTopology{2, 0}));
}

TEST(MeshTopology, SumsOverComponents) {
  auto triangles = torus(4, 3);  // 0..11
  for (const Triangle& t : band(4, false))
    triangles.push_back({t[0] + 12, t[1] + 12, t[2] + 12});  // 12..19
  for (const Triangle& t : tetrahedron(20, 21, 22, 23)) triangles.push_back(t);
  const MeshTopology t = mesh_topology(mesh_of(24, triangles));
  EXPECT_TRUE(t.is_manifold() && t.is_oriented());
  EXPECT_EQ(t.components, (std::vector<ComponentTopology>{{0, 0}, {0, 2}, {2, 0}}));
  EXPECT_EQ(t.euler_characteristic(), 2);
  EXPECT_EQ(t.genus(), 1);
  EXPECT_EQ(t.boundary_loops(), 2);
}

TEST(MeshTopology, DoesNotDependOnTheOrderOfTrianglesOrVertices) {
  Random random(5);
  const auto triangles = torus(6, 5) + std::vector<Triangle>{};
  for (int round = 0; round < 20; ++round) {
    std::vector<std::uint32_t> rename(30);
    for (std::uint32_t i = 0; i < 30; ++i) rename[i] = i;
    for (std::uint32_t i = 29; i > 0; --i) std::swap(rename[i], rename[random.bits() % (i + 1)]);
    auto shuffled = triangles;
    for (std::size_t i = shuffled.size() - 1; i > 0; --i)
      std::swap(shuffled[i], shuffled[random.bits() % (i + 1)]);
    for (Triangle& t : shuffled) {
      t = {rename[t[0]], rename[t[1]], rename[t[2]]};
      for (std::uint64_t k = random.bits() % 3; k > 0; --k) t = {t[1], t[2], t[0]};
    }
    const MeshTopology t = mesh_topology(mesh_of(30, shuffled));
    ASSERT_TRUE(t.is_manifold() && t.is_oriented());
    ASSERT_EQ(t.components, (std::vector<ComponentTopology>{{0, 0}}));
  }
}

// Tori with triangles removed, reversed and glued at random vertices, against another counter.
TEST(MeshTopology, AgreesWithAnIndependentCount) {
  Random random(6);
  std::size_t manifolds = 0, faults = 0;
  for (int round = 0; round < 3000; ++round) {
    std::vector<Triangle> triangles = torus(5, 4);
    if (random.bits() % 2 == 0)
      for (const Triangle& t : tetrahedron(20, 21, 22, 23)) triangles.push_back(t);
    for (std::uint64_t k = random.bits() % 8; k > 0; --k)
      triangles.erase(triangles.begin() +
                      static_cast<std::ptrdiff_t>(random.bits() % triangles.size()));
    const std::uint64_t damage = random.bits() % 6;
    if (damage == 0) std::swap(triangles[0][0], triangles[0][1]);
    if (damage == 1) {
      const auto from = static_cast<std::uint32_t>(random.bits() % 24),
                 to = static_cast<std::uint32_t>(random.bits() % 24);
      for (Triangle& t : triangles)
        for (std::uint32_t& corner : t) corner = corner == from ? to : corner;
    }
    std::vector<std::uint32_t> id(24, kNone);  // vertices in the order of their first use
    std::uint32_t count = 0;
    for (Triangle& t : triangles)
      for (std::uint32_t& corner : t)
        corner = id[corner] == kNone ? id[corner] = count++ : id[corner];
    const TriangleMesh mesh = mesh_of(count + (damage == 2 ? 1 : 0), triangles);
    const MeshTopology found = mesh_topology(mesh);
    const test::MeshCounts counts = test::count_mesh(mesh);
    const bool is_sound = found.is_manifold() && found.is_oriented() && found.unused_vertices == 0;
    ASSERT_EQ(is_sound, counts.fault.empty()) << round << ": " << counts.fault;
    (is_sound ? manifolds : faults) += 1;
    if (!is_sound) continue;
    ASSERT_EQ(found.edges, counts.edges) << round;
    ASSERT_EQ(found.component_of_vertex, counts.component_of_vertex) << round;
    ASSERT_EQ(found.components, counts.components) << round;
    ASSERT_EQ(summarize(found.components), counts.topology) << round;
  }
  EXPECT_GT(manifolds, 300u);
  EXPECT_GT(faults, 300u);
}

TEST(Summarize, CollectsKindsInOrder) {
  const TopologySummary s =
      summarize(std::vector<ComponentTopology>{{2, 0}, {-2, 0}, {1, 1}, {2, 0}, {0, 2}});
  EXPECT_EQ(s.components, 5u);
  EXPECT_EQ(s.euler_characteristic, 3);
  EXPECT_EQ(s.genus, 2);
  EXPECT_EQ(s.boundary_loops, 3);
  EXPECT_EQ(s.kinds,
            (std::vector<TopologySummary::Kind>{{0, 0, 2}, {0, 1, 1}, {0, 2, 1}, {2, 0, 1}}));
}

}  // namespace
}  // namespace isoatlas::detail
