// SPDX-License-Identifier: Apache-2.0
// The certificate must pass valid partitions and detect every kind of planted fault; and partitions
// that pass must have a homeomorphic dual.
#include "complex/certificate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "support/reference_topology.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

// Assigns cells by a rule that maps c-vertices to any numbers; equal numbers are one cell. kAlone:
// a cell of its own.
constexpr int kAlone = -1;
template <class Rule>
Partition cells_by(const SurfaceComplex& surface, Rule rule) {
  Partition out;
  out.cell_of.resize(surface.c_vertex_count());
  std::map<int, CellId> named;
  for (CVertexId v = 0; v < surface.c_vertex_count(); ++v) {
    const int key = rule(v);
    if (key == kAlone || !named.count(key)) {
      out.cell_of[v] = out.cell_count();
      if (key != kAlone) named[key] = out.cell_count();
      out.site.push_back(v);
    } else {
      out.cell_of[v] = named[key];
    }
    if (surface.on_boundary[v] && !surface.on_boundary[out.site[out.cell_of[v]]])
      out.site[out.cell_of[v]] = v;
  }
  return out;
}

PartitionCheck check(const SurfaceComplex& surface, const Partition& partition) {
  return check_partition(surface, partition.cell_of, partition.cell_count(), partition.site);
}

bool has_pair(const PartitionCheck& c, CellId a, CellId b) {
  return std::any_of(c.pair_faults.begin(), c.pair_faults.end(), [&](const PairFault& p) {
    return p.a == std::min(a, b) && p.b == std::max(a, b);
  });
}

SurfaceComplex ball() { return surface_of(sampled({16, 16, 16}, sphere({7.4, 7.6, 7.55}, 5.8))); }

TEST(Certificate, SinglesPassOnEverySurface) {
  std::vector<std::pair<std::string, SurfaceComplex>> surfaces{
      {"tetrahedron", tetrahedron()}, {"grid", flat_grid(5, 6)}, {"tube", tube(5, 4)}};
  for (const KnownVolume& known : known_volumes())
    surfaces.emplace_back(known.name, surface_of(known.samples, known.isovalue));
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const auto family = static_cast<Family>(seed % kFamilies);
    const Samples s = random_samples(family, {7, 6, 8}, seed);
    if (has_surface(s, 0)) surfaces.emplace_back(name(family), surface_of(s));
  }
  for (const auto& [what, surface] : surfaces) {
    std::vector<CVertexId> all(surface.c_vertex_count());
    std::iota(all.begin(), all.end(), 0u);
    const Partition singles{all, all};
    const PartitionCheck c = check(surface, singles);
    EXPECT_TRUE(c.passed()) << what;
    EXPECT_EQ(c.cells, all.size());
    EXPECT_TRUE(check_partition(surface, all, surface.c_vertex_count(), {}).passed())
        << what << ", no sites";
    const SurfaceComplex dual = dual_complex(surface, singles, c.triangles);
    EXPECT_EQ(validate(dual), "") << what;
    EXPECT_EQ(kinds_of(triangles_of(dual)), kinds_of(triangles_of(surface))) << what;
  }
}

TEST(Certificate, GoodBlocksPass) {
  // 12 x 12 c-vertices in blocks of 3 x 3: a coarser grid.
  const SurfaceComplex grid = flat_grid(12, 12);
  const Partition blocks =
      cells_by(grid, [](CVertexId v) { return static_cast<int>(v % 12 / 3 + 4 * (v / 12 / 3)); });
  const PartitionCheck c = check(grid, blocks);
  EXPECT_TRUE(c.passed());
  EXPECT_EQ(c.cells, 16u);
  EXPECT_EQ(c.pairs, 33u) << "24 sides and 9 diagonals";
  EXPECT_EQ(c.triangles.size(), 18u);
  const SurfaceComplex dual = dual_complex(grid, blocks, c.triangles);
  EXPECT_EQ(validate(dual), "");
  EXPECT_EQ(dual.c_vertex_count(), 16u);
  EXPECT_EQ(dual.boundary.size(), 12u);
  for (CellId cell = 0; cell < 16; ++cell) {
    EXPECT_EQ(dual.positions[cell], grid.positions[blocks.site[cell]]);
    EXPECT_EQ(dual.on_boundary[cell] != 0,
              cell % 4 == 0 || cell % 4 == 3 || cell / 4 == 0 || cell / 4 == 3);
  }
}

TEST(Certificate, AnnulusIsNotADisk) {
  const SurfaceComplex grid = flat_grid(9, 9);
  const Partition p = cells_by(grid, [](CVertexId v) {
    const int d =
        std::max(std::abs(static_cast<int>(v % 9) - 4), std::abs(static_cast<int>(v / 9) - 4));
    return d == 2 ? 1 : kAlone;
  });
  const PartitionCheck c = check(grid, p);
  const CellId ring = p.cell_of[2 + 9 * 2];
  EXPECT_EQ(c.fault_of(ring), kNotADisk);
  EXPECT_EQ(c.faulty_cells.size(), 1u);
  EXPECT_FALSE(c.passed());
}

TEST(Certificate, CellInTwoPieces) {
  const SurfaceComplex grid = flat_grid(9, 9);
  const Partition p = cells_by(grid, [](CVertexId v) { return v == 20 || v == 60 ? 1 : kAlone; });
  const PartitionCheck c = check(grid, p);
  EXPECT_TRUE(c.fault_of(p.cell_of[20]) & kNotConnected);
  EXPECT_EQ(c.faulty_cells.size(), 1u);
}

TEST(Certificate, DiskAndAnnulusThatSumToOne) {
  const SurfaceComplex grid = flat_grid(12, 12);
  const Partition p = cells_by(grid, [](CVertexId v) {
    const int x = static_cast<int>(v % 12), y = static_cast<int>(v / 12);
    return std::max(std::abs(x - 3), std::abs(y - 3)) == 1 || (x == 8 && y == 8) ? 1 : kAlone;
  });
  const PartitionCheck c = check(grid, p);
  EXPECT_EQ(c.fault_of(p.cell_of[8 + 12 * 8]), kNotConnected)
      << "V - E + F is 1, so only connectedness is violated";
}

TEST(Certificate, TwoCellsWithTwoCommonArcsAroundATube) {
  const SurfaceComplex t = tube(12, 9);
  const Partition p = cells_by(t, [](CVertexId v) {
    const int row = static_cast<int>(v / 12);
    return row < 3 || row > 5 ? kAlone : v % 12 < 6 ? 1 : 2;
  });
  const PartitionCheck c = check(t, p);
  EXPECT_EQ(c.faulty_cells.size(), 0u) << "each is a disk";
  EXPECT_TRUE(has_pair(c, p.cell_of[0 + 12 * 4], p.cell_of[6 + 12 * 4]));
  EXPECT_EQ(c.pair_faults.size(), 1u);
}

TEST(Certificate, ThreeCellsThatMakeAPillow) {
  const SurfaceComplex surface = ball();
  const Partition p = cells_by(surface, [&](CVertexId v) {
    const Vec3 q = surface.positions[v];
    const double angle = std::atan2(q.y - 7.61, q.x - 7.43) + M_PI;
    return std::min(2, static_cast<int>(angle * 3 / (2 * M_PI)));
  });
  const PartitionCheck c = check(surface, p);
  ASSERT_EQ(c.cells, 3u);
  EXPECT_EQ(c.faulty_cells.size(), 0u) << "three lunes, each a disk with triangles";
  EXPECT_EQ(c.triangles.size(), 2u);
  EXPECT_EQ(c.pair_faults.size(), 3u) << "the dual would be the same triangle twice";
}

TEST(Certificate, WholeComponentInOneCell) {
  const SurfaceComplex surface = ball();
  const PartitionCheck c = check(surface, cells_by(surface, [](CVertexId) { return 0; }));
  EXPECT_TRUE(c.fault_of(0) & kNoTriangle);
  EXPECT_TRUE(c.fault_of(0) & kNotADisk);
  const SurfaceComplex grid = flat_grid(4, 4);
  const PartitionCheck disk = check(grid, cells_by(grid, [](CVertexId) { return 0; }));
  EXPECT_TRUE(disk.fault_of(0) & kNoTriangle);
  EXPECT_FALSE(disk.fault_of(0) & kNotADisk);
}

TEST(Certificate, TwoHalvesOfABall) {
  const SurfaceComplex surface = ball();
  const PartitionCheck c =
      check(surface,
            cells_by(surface, [&](CVertexId v) { return surface.positions[v].z < 7.55 ? 0 : 1; }));
  EXPECT_TRUE(c.fault_of(0) & kNoTriangle);
  EXPECT_TRUE(c.fault_of(1) & kNoTriangle);
  EXPECT_FALSE(c.passed());
}

TEST(Certificate, CellWithASingleNeighbour) {
  const SurfaceComplex grid = flat_grid(9, 9);  // a cell with a hole that another cell fills
  const Partition p = cells_by(grid, [](CVertexId v) {
    const int d =
        std::max(std::abs(static_cast<int>(v % 9) - 4), std::abs(static_cast<int>(v / 9) - 4));
    return d < 2 ? 1 : d == 2 ? 2 : kAlone;
  });
  const PartitionCheck c = check(grid, p);
  EXPECT_TRUE(c.fault_of(p.cell_of[4 + 9 * 4]) & kNoTriangle);
  EXPECT_TRUE(c.fault_of(p.cell_of[2 + 9 * 2]) & kNotADisk);
}

TEST(Certificate, CellTouchesTheBoundaryTwice) {
  const SurfaceComplex grid =
      flat_grid(9, 5);  // a column from one side to the other: a disk, but it separates the surface
  const Partition p = cells_by(grid, [](CVertexId v) { return v % 9 == 4 ? 1 : kAlone; });
  const PartitionCheck c = check(grid, p);
  EXPECT_EQ(c.fault_of(p.cell_of[4]), kBadBoundary);
  EXPECT_EQ(c.faulty_cells.size(), 1u);
}

TEST(Certificate, WholeBoundaryLoopInOneCell) {
  const SurfaceComplex t = tube(8, 6);
  const Partition p = cells_by(t, [](CVertexId v) { return v < 8 ? 1 : kAlone; });
  const PartitionCheck c = check(t, p);
  EXPECT_TRUE(c.fault_of(p.cell_of[0]) & kBadBoundary);
  EXPECT_TRUE(c.fault_of(p.cell_of[0]) & kNotADisk);
}

TEST(Certificate, SiteNotOnTheBoundary) {
  const SurfaceComplex grid = flat_grid(9, 9);
  Partition p = cells_by(grid, [](CVertexId v) { return v == 4 || v == 4 + 9 ? 1 : kAlone; });
  EXPECT_TRUE(check(grid, p).passed());
  p.site[p.cell_of[4]] = 4 + 9;
  const PartitionCheck c = check(grid, p);
  EXPECT_EQ(c.fault_of(p.cell_of[4]), kBadBoundary);
  EXPECT_EQ(c.faulty_cells.size(), 1u);
}

TEST(Certificate, TwoCellsOnATriangle) {
  // A disk split in two: one arc with both ends on the boundary, and no triangle. The dual would be
  // a single edge.
  const SurfaceComplex grid = flat_grid(6, 4);
  const PartitionCheck c =
      check(grid, cells_by(grid, [](CVertexId v) { return v % 6 < 3 ? 0 : 1; }));
  EXPECT_FALSE(c.passed());
  EXPECT_TRUE(has_pair(c, 0, 1));
}

TEST(Certificate, CellsWithoutCVerticesAreSkipped) {
  const SurfaceComplex grid = flat_grid(4, 4);
  std::vector<CellId> cell_of(16);
  for (CVertexId v = 0; v < 16; ++v) cell_of[v] = 2 * v + 5;
  const PartitionCheck c = check_partition(grid, cell_of, 50, {});
  EXPECT_TRUE(c.passed());
  EXPECT_EQ(c.cells, 16u);
}

TEST(CutFace, QuadsByTheirLabels) {
  SurfaceComplex quad;
  quad.positions = {{0, 0, 0},
                    {3, 0, 0},
                    {3, 1, 0},
                    {0, 1.5, 0}};  // 1-3 is shorter than 0-2? 3.35 against 3.16: 0-2 is
  quad.faces = {{{0, 1, 2, 3}}};
  const auto cut = [&](CellId a, CellId b, CellId c, CellId d) {
    return cut_face(quad, quad.faces[0], {a, b, c, d}, {});
  };
  EXPECT_EQ(cut(1, 1, 1, 1).triangles, 0);
  EXPECT_EQ(cut(1, 1, 2, 2).triangles, 0);
  EXPECT_EQ(cut(1, 1, 1, 2).triangles, 0);
  EXPECT_EQ(cut(1, 1, 1, 2).joined, kNone) << "joined along sides already";
  EXPECT_EQ(cut(1, 1, 2, 3).triangles, 1);
  EXPECT_EQ(cut(1, 1, 2, 3).triangle[0].cell, (std::array<CellId, 3>{1, 2, 3}));
  EXPECT_EQ(cut(1, 2, 1, 3).triangles, 0);
  EXPECT_EQ(cut(1, 2, 1, 3).joined, 1u);
  EXPECT_EQ(cut(2, 1, 3, 1).joined, 1u);
  EXPECT_EQ(cut(2, 1, 3, 1).joined_corner, 1);
  EXPECT_EQ(cut(1, 2, 1, 2).joined, 1u) << "the shorter diagonal";
  std::swap(quad.positions[0].x, quad.positions[1].x);  // still a loop, but now 1-3 is shorter
  quad.positions = {{0, 0, 0}, {3, 0.5, 0}, {3, 2, 0}, {0, 1, 0}};
  EXPECT_EQ(cut(1, 2, 1, 2).joined, 2u);
  EXPECT_EQ(cut(1, 2, 3, 4).triangles, 2);
}

// Soundness: if a partition passes the certificate, its dual is a simplicial manifold with the same
// components, genus and loops. Random Voronoi cells by breadth-first search, few and many; many
// fail, and all that pass are checked.
TEST(Certificate, IsSound) {
  Random random(11);
  int passed = 0, failed = 0;
  std::vector<SurfaceComplex> surfaces;
  for (const KnownVolume& known : known_volumes()) {
    if (known.samples.values.size() < 16000)
      surfaces.push_back(surface_of(known.samples, known.isovalue));
  }
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    const auto family = static_cast<Family>(seed % kFamilies);
    const Samples s = random_samples(family, {8, 7, 8}, seed + 50);
    if (has_surface(s, 0)) surfaces.push_back(surface_of(s));
  }
  for (const SurfaceComplex& surface : surfaces) {
    const CVertexGraph graph = make_graph(surface);
    const std::uint32_t n = surface.c_vertex_count();
    const auto want = kinds_of(triangles_of(surface));
    for (int round = 0; round < 30; ++round) {
      Partition p;
      p.cell_of.assign(n, kNone);
      std::vector<CVertexId> queue;
      const auto start = [&](CVertexId v) {
        if (p.cell_of[v] != kNone) return;
        p.cell_of[v] = p.cell_count();
        p.site.push_back(v);
        queue.push_back(v);
      };
      const std::uint64_t sites = 1 + static_cast<std::uint64_t>(n * std::pow(random.unit(), 3));
      for (std::uint64_t k = 0; k < sites; ++k) start(static_cast<CVertexId>(random.bits() % n));
      for (CVertexId next = 0; next < n;) {
        for (std::size_t i = 0; i < queue.size(); ++i) {
          for (const auto& neighbour : graph.row(queue[i])) {
            if (p.cell_of[neighbour.id] != kNone) continue;
            p.cell_of[neighbour.id] = p.cell_of[queue[i]];
            queue.push_back(neighbour.id);
          }
        }
        queue.clear();
        while (next < n && p.cell_of[next] != kNone) ++next;
        for (int k = 0; next < n && k < 6; ++k) start(next);
      }
      for (CVertexId v = 0; v < n; ++v) {
        if (surface.on_boundary[v] && !surface.on_boundary[p.site[p.cell_of[v]]])
          p.site[p.cell_of[v]] = v;
      }
      const PartitionCheck c =
          round % 2 ? check(surface, p) : check_partition(surface, p.cell_of, p.cell_count(), {});
      if (!c.passed()) {
        ++failed;
        continue;
      }
      ++passed;
      const SurfaceComplex dual = dual_complex(surface, p, c.triangles);
      ASSERT_EQ(validate(dual), "");
      ASSERT_EQ(kinds_of(triangles_of(dual)), want);
    }
  }
  EXPECT_GT(passed, 100);
  EXPECT_GT(failed, 100);
}

// Completeness: a partition whose dual is not such a manifold, or a different one, never passes.
// Uses a passed partition with two cells merged or one c-vertex moved to another cell.
TEST(Certificate, IsComplete) {
  Random random(12);
  int broken = 0;
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    const auto family = static_cast<Family>(seed % kFamilies);
    const Samples s = random_samples(family, {7, 7, 7}, seed + 90);
    if (!has_surface(s, 0)) continue;
    const SurfaceComplex surface = surface_of(s);
    const std::uint32_t n = surface.c_vertex_count();
    const auto want = kinds_of(triangles_of(surface));
    for (int round = 0; round < 60; ++round) {
      Partition p;
      p.cell_of.resize(n);
      p.site.resize(n);
      std::iota(p.cell_of.begin(), p.cell_of.end(), 0u);
      std::iota(p.site.begin(), p.site.end(), 0u);
      for (int k = 0; k < 2 + round / 6; ++k)
        p.cell_of[random.bits() % n] = p.cell_of[random.bits() % n];
      const PartitionCheck c = check_partition(surface, p.cell_of, n, {});
      // The dual's vertices are the cells in use.
      std::vector<std::uint32_t> used(n, kNone);
      std::uint32_t count = 0;
      for (CVertexId v = 0; v < n; ++v) {
        if (used[p.cell_of[v]] == kNone) used[p.cell_of[v]] = count++;
      }
      TriangleMesh mesh;
      mesh.positions.resize(count);
      for (const DualTriangle& t : c.triangles)
        mesh.triangles.push_back({used[t.cell[0]], used[t.cell[1]], used[t.cell[2]]});
      bool good = false;
      try {
        good = kinds_of(mesh) == want;
      } catch (const std::runtime_error&) {
      }
      if (!good) {
        ++broken;
        ASSERT_FALSE(c.passed()) << name(family) << " seed " << seed << " round " << round;
      }
    }
  }
  EXPECT_GT(broken, 100);
}

}  // namespace
}  // namespace isoatlas::detail
