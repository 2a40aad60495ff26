// SPDX-License-Identifier: Apache-2.0
// The adjacency of a level's mesh, and distances between it and the surface, against brute force.
#include "error/level_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/vector_math.h"
#include "error/error_field.h"
#include "error/triangle_errors.h"
#include "geometry/closest_point.h"
#include "support/levels.h"

namespace isoatlas::detail {
namespace {

using namespace test;

TEST(LevelMesh, AdjacencyListsEveryTriangleAndCVertex) {
  const TestLevel level(exact_surface({28, 28, 28}, bumpy_ball()), 5);
  const LevelMesh& mesh = level.mesh();
  std::size_t corners = 0, c_vertices = 0;
  for (CellId c = 0; c < mesh.cell_count(); ++c) {
    for (const std::uint32_t t : mesh.triangles_of.row(c)) {
      const auto& cell = mesh.triangles[t];
      EXPECT_NE(std::find(cell.begin(), cell.end(), c), cell.end());
      ++corners;
    }
    const auto own = mesh.c_vertices_of.row(c);
    EXPECT_TRUE(std::is_sorted(own.begin(), own.end()));
    for (const CVertexId v : own) EXPECT_EQ(level.partition().cell_of[v], c);
    c_vertices += own.size();
    EXPECT_EQ(mesh.point[c], level.surface_data().surfels.point[level.partition().site[c]]);
  }
  EXPECT_EQ(corners, 3 * mesh.triangles.size());
  EXPECT_EQ(c_vertices, level.surface_data().complex.c_vertex_count());
  for (const Vec3 normal : mesh.triangle_normal) EXPECT_NEAR(length(normal), 1, 1e-12);
}

TEST(LevelMesh, AdjacencyOfNothingAndOfEmptyGroups) {
  const CsrAdjacency none = make_csr_adjacency(0, [](auto) {});
  EXPECT_EQ(none.first.size(), 1u);
  const CsrAdjacency some = make_csr_adjacency(4, [](auto add) {
    add(2, 7);
    add(0, 5);
    add(2, 6);
  });
  EXPECT_EQ(some.of(0).size(), 1u);
  EXPECT_TRUE(some.of(1).empty());
  EXPECT_EQ(some.of(2)[0], 7u) << "in the order in which they come";
  EXPECT_EQ(some.of(2)[1], 6u);
  EXPECT_TRUE(some.of(3).empty());
}

TEST(LevelMesh, PlacingMovesCornersAndNormals) {
  const TestLevel level(exact_volume({28, 28, 28}, bumpy_ball()), 6);
  LevelMesh mesh = level.mesh();
  VertexPlacement placement{level.partition().site, std::vector<float>(mesh.cell_count(), 0)};
  placement.normal_offset[3] = 0.5f;
  const std::vector<CellId> moved{3};
  update_points(mesh, level.surface_data().surfels, moved, placement);
  EXPECT_NEAR(length(mesh.point[3] - level.mesh().point[3]), 0.5, 1e-6);
  const LevelMesh again = make_level_mesh(level.surface_data().surfels, level.partition(),
                                          level.triangles(), placement);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    EXPECT_EQ(mesh.corners(t), again.corners(t));
    EXPECT_EQ(mesh.triangle_normal[t], again.triangle_normal[t]);
  }
}

// Compares with all triangles around a cell and around its neighbours.
TEST(FindClosest, IsTheClosestOfTheTwoRing) {
  for (const float disk : {3.0f, 7.0f}) {
    const TestLevel level(exact_surface({28, 28, 28}, bumpy_ball()), disk);
    const LevelMesh& mesh = level.mesh();
    for (CellId c = 0; c < mesh.cell_count(); ++c) {
      std::set<std::uint32_t> ring;
      for (const std::uint32_t t : mesh.triangles_of.row(c)) {
        for (const CellId n : mesh.triangles[t])
          ring.insert(mesh.triangles_of.row(n).begin(), mesh.triangles_of.row(n).end());
      }
      const auto own = mesh.c_vertices_of.row(c);
      for (std::size_t i = 0; i < own.size(); ++i) {
        const Vec3 p = level.surface_data().surfels.point[own[i]];
        double want = 1e30;
        for (const std::uint32_t t : ring) {
          const std::array<Vec3, 3> q = mesh.corners(t);
          want = std::min(want, closest_on_triangle(p, q[0], q[1], q[2]).squared_distance);
        }
        const ClosestPoint& got = level.closest(c)[i];
        ASSERT_NEAR(got.distance, std::sqrt(want), 1e-6);
        ASSERT_TRUE(ring.contains(got.triangle));
        Vec3 at;
        for (std::size_t k = 0; k < 3; ++k)
          at = at + static_cast<double>(got.weight[k]) * mesh.corners(got.triangle)[k];
        ASSERT_NEAR(length(p - at), got.distance, 1e-5) << "weights and distance are of one point";
      }
    }
  }
}

// A mesh whose vertices are on the two brims of a deep, narrow valley is far from the surface,
// although its vertices are on it.
TEST(MeasureFromMesh, FindsATriangleThatBridgesAFold) {
  // The valley's walls have a slope of 2, its bottom is 8 below the brims.
  const Volume volume = exact_volume({21, 9, 20}, [](double x, double, double z) {
    return 12 - 2 * std::max(0.0, 4 - std::abs(x - 10)) - z;
  });
  ParseOptions options;
  options.rule = {0, Inside::above, NonFinite::refuse};
  const SurfaceComplex sheet = parse_surface(volume, options);
  const Isosurface isosurface(volume, options.rule, sheet);
  const SurfaceData surface_data(sheet, &isosurface);
  const auto at = [&](double x, double y) {
    CVertexId nearest = 0;
    const auto away = [&](CVertexId v) {
      return std::hypot(sheet.positions[v].x - x, sheet.positions[v].y - y);
    };
    for (CVertexId v = 0; v < sheet.c_vertex_count(); ++v)
      nearest = away(v) < away(nearest) ? v : nearest;
    return nearest;
  };
  Partition partition;
  partition.site = {at(4, 2), at(16, 2), at(4, 6)};
  partition.cell_of.resize(sheet.c_vertex_count());
  for (CVertexId v = 0; v < sheet.c_vertex_count(); ++v)
    partition.cell_of[v] = sheet.positions[v].y > 4 ? 2 : sheet.positions[v].x < 10 ? 0 : 1;
  for (CellId c = 0; c < 3; ++c) partition.cell_of[partition.site[c]] = c;
  const std::vector<DualTriangle> dual{{{0, 1, 2}, 0}};
  const LevelMesh mesh =
      make_level_mesh(surface_data.surfels, partition, dual, {partition.site, {}});
  const std::vector<CellId> all{0, 1, 2};
  for (const Evidence look : {Evidence::samples, Evidence::proof}) {
    std::vector<Farthest> from_mesh;
    measure_from_mesh(surface_data.measured_surface(), mesh, partition.cell_of, all, 0.5, look,
                      from_mesh);
    ASSERT_EQ(from_mesh.size(), 3u);
    // Above the middle of the valley the walls are nearest: at height 8 they are 8 / sqrt(5) away.
    const float most =
        std::max({from_mesh[0].distance, from_mesh[1].distance, from_mesh[2].distance});
    EXPECT_GT(most, 2.5f);
    EXPECT_LT(most, 8 / std::sqrt(5.0f) + 0.1f);
  }
}

TEST(MeasureFromMesh, KeepsOtherCells) {
  const TestLevel level(exact_volume({28, 28, 28}, bumpy_ball()), 6);
  const LevelMesh& mesh = level.mesh();
  std::vector<CellId> all(mesh.cell_count());
  std::iota(all.begin(), all.end(), 0u);
  const Farthest untouched{77, 7};
  std::vector<Farthest> whole, part(mesh.cell_count(), untouched);
  measure_from_mesh(level.surface_data().measured_surface(), mesh, level.partition().cell_of, all,
                    0, Evidence::samples, whole);
  const std::vector<CellId> some{1, 4, 9};
  for (const CellId c : some) part[c] = {};
  measure_from_mesh(level.surface_data().measured_surface(), mesh, level.partition().cell_of, some,
                    0, Evidence::samples, part);
  for (CellId c = 0; c < mesh.cell_count(); ++c) {
    const bool is_listed = std::find(some.begin(), some.end(), c) != some.end();
    EXPECT_EQ(part[c], is_listed ? whole[c] : untouched) << c;
  }
  std::vector<Farthest> known = whole;  // known distances are not found again
  measure_from_mesh(level.surface_data().measured_surface(), mesh, level.partition().cell_of, all,
                    0, Evidence::samples, known);
  EXPECT_EQ(known, whole);
  for (Farthest& most : known) most.distance /= 2;
  measure_from_mesh(level.surface_data().measured_surface(), mesh, level.partition().cell_of, all,
                    0, Evidence::samples, known);
  EXPECT_EQ(known, whole);
}

// Triangles that have not moved are not sampled again; others are.
TEST(MeasureFromMesh, CachedErrorsAreThoseOfTheSameTriangle) {
  const TestLevel level(exact_volume({28, 28, 28}, bumpy_ball()), 6);
  LevelMesh mesh = level.mesh();
  std::vector<CellId> all(mesh.cell_count());
  std::iota(all.begin(), all.end(), 0u);
  TriangleErrorCache errors;
  std::vector<Farthest> once(all.size()), twice(all.size()), moved(all.size()), anew(all.size());
  const auto measure = [&](std::vector<Farthest>& out, TriangleErrorCache* known) {
    measure_from_mesh(level.surface_data().measured_surface(), mesh, level.partition().cell_of, all,
                      0, Evidence::samples, out, known);
  };
  measure(once, &errors);
  measure(twice, &errors);
  EXPECT_EQ(once, twice);
  mesh.point[3].x += 0.5;
  measure(moved, &errors);
  measure(anew, nullptr);
  EXPECT_EQ(moved, anew);
  EXPECT_NE(moved, once);
}

// Results for one bound are used for another one, if they are exact enough.
TEST(MeasureFromMesh, CachedErrorsAreUsedForOtherBounds) {
  const TestLevel level(exact_volume({28, 28, 28}, bumpy_ball()), 6);
  const LevelMesh& mesh = level.mesh();
  std::vector<CellId> all(mesh.cell_count());
  std::iota(all.begin(), all.end(), 0u);
  TriangleErrorCache sampled, proved;
  Random random(4);
  std::size_t kinds[2] = {0, 0};
  for (int k = 0; k < 30; ++k) {
    const double enough = 0.05 + 1e-4 * static_cast<double>(random.bits() % 10000);
    for (const Evidence look : {Evidence::samples, Evidence::proof}) {
      std::vector<Farthest> known(all.size()), anew(all.size());
      const auto measure = [&](std::vector<Farthest>& out, TriangleErrorCache* errors) {
        measure_from_mesh(level.surface_data().measured_surface(), mesh, level.partition().cell_of,
                          all, enough, look, out, errors);
      };
      measure(known, look == Evidence::proof ? &proved : &sampled);
      measure(anew, nullptr);
      const auto farther = [](const Farthest& x, const Farthest& y) {
        return x.distance < y.distance;
      };
      const auto is_over = [&](const Farthest& f) {
        return static_cast<double>(f.distance) > enough;
      };
      // A proof of a tighter bound may have found points that one of this bound does not find.
      ASSERT_LE(is_over(*std::ranges::max_element(known, farther)),
                is_over(*std::ranges::max_element(anew, farther)))
          << "bound " << enough;
      for (const CellId c : all) {
        if (look == Evidence::proof)
          break;  // which cell has the farthest point depends on how a triangle is subdivided
        ++kinds[is_over(anew[c])];
        ASSERT_EQ(is_over(known[c]), is_over(anew[c])) << "bound " << enough << ", cell " << c;
        ASSERT_EQ(known[c], is_over(anew[c]) ? anew[c] : known[c])
            << "bound " << enough << ", cell " << c;
      }
    }
  }
  EXPECT_GT(kinds[0], 100u);
  EXPECT_GT(kinds[1], 100u);
}

}  // namespace
}  // namespace isoatlas::detail
