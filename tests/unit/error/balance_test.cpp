// SPDX-License-Identifier: Apache-2.0
#include "error/balance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/vector_math.h"
#include "support/levels.h"

namespace isoatlas::detail {
namespace {

using namespace test;

std::vector<CellId> all_of(const LevelMesh& mesh) {
  std::vector<CellId> out(mesh.cell_count());
  std::iota(out.begin(), out.end(), 0u);
  return out;
}

struct Distances {
  double signed_mean = 0, absolute_mean = 0;
};

// Of the surface above the mesh, weighted by area.
Distances distances(const TestLevel& level, const LevelMesh& mesh) {
  std::vector<ClosestPoint> closest;
  find_closest(level.ground().measured(), mesh, all_of(mesh), closest);
  Distances out;
  double area = 0;
  const Surfels& surfels = level.ground().surfels;
  std::size_t next = 0;
  for (CellId c = 0; c < mesh.cell_count(); ++c) {
    const auto own = mesh.c_vertices_of.row(c);
    for (std::size_t i = 0; i < own.size(); ++i) {
      const std::uint32_t t = closest[next++].triangle;
      const double d = dot(mesh.triangle_normal[t], surfels.point[own[i]] - mesh.corners(t)[0]);
      out.signed_mean += surfels.area[own[i]] * d;
      out.absolute_mean += surfels.area[own[i]] * std::abs(d);
      area += surfels.area[own[i]];
    }
  }
  return {out.signed_mean / area, out.absolute_mean / area};
}

// Inscribed, the mesh lies inside by two thirds or so of its sagittas on average; balanced, on both sides.
TEST(Balance, ASphereLiesEvenlyOnBothSides) {
  for (const float disk : {4.0f, 8.0f}) {
    const TestLevel level(exact_surface({48, 48, 48}, sphere({23.4, 23.6, 23.55}, 20)), disk);
    LevelMesh mesh = level.mesh();
    VertexPlacement places{level.partition().site, {}};
    const Distances before = distances(level, mesh);
    EXPECT_GT(before.signed_mean, 0.9 * before.absolute_mean) << "inscribed";
    balance(level.ground().measured(), all_of(mesh), mesh, places);
    const Distances after = distances(level, mesh);
    EXPECT_LT(std::abs(after.signed_mean), 0.1 * before.signed_mean);
    EXPECT_LT(after.absolute_mean, 0.6 * before.absolute_mean);
    for (const float o : places.offset) EXPECT_GE(o, -0.1f) << "outwards";
  }
}

TEST(Balance, APlaneAndBoundaryVerticesStay) {
  const TestLevel flat(flat_grid(31, 27), 5);
  LevelMesh mesh = flat.mesh();
  VertexPlacement places{flat.partition().site, {}};
  balance(flat.ground().measured(), all_of(mesh), mesh, places);
  for (CellId c = 0; c < mesh.cell_count(); ++c) {
    EXPECT_EQ(places.offset[c], 0);
    EXPECT_EQ(mesh.point[c], flat.mesh().point[c]);
  }

  const TestLevel cut(exact_surface({24, 24, 24}, sphere({11.4, 11.6, 2.55}, 9.5)), 4);
  LevelMesh cut_mesh = cut.mesh();
  VertexPlacement cut_places{cut.partition().site, {}};
  balance(cut.ground().measured(), all_of(cut_mesh), cut_mesh, cut_places);
  int on_boundary = 0, moved = 0;
  for (CellId c = 0; c < cut_mesh.cell_count(); ++c) {
    if (cut.ground().graph.on_boundary[cut.partition().site[c]]) {
      ++on_boundary;
      EXPECT_EQ(cut_places.offset[c], 0);
    }
    moved += cut_places.offset[c] != 0;
  }
  EXPECT_GT(on_boundary, 5);
  EXPECT_GT(moved, 5);
}

// Others' vertices stay, and so do those with a neighbour that is not asked for.
TEST(Balance, OnlyInnerCellsOfThoseAskedForMove) {
  const TestLevel level(exact_surface({48, 48, 48}, sphere({23.4, 23.6, 23.55}, 20)), 6);
  LevelMesh mesh = level.mesh();
  VertexPlacement places{level.partition().site, {}};
  std::vector<CellId> some;
  for (CellId c = 0; c < mesh.cell_count(); ++c) {
    if (mesh.point[c].z > 23) some.push_back(c);
  }
  balance(level.ground().measured(), some, mesh, places);
  int moved = 0;
  for (CellId c = 0; c < mesh.cell_count(); ++c) {
    bool inner = true;
    for (const std::uint32_t t : mesh.triangles_of.row(c)) {
      for (const CellId n : mesh.triangles[t]) inner = inner && level.mesh().point[n].z > 23;
    }
    if (!inner) {
      EXPECT_EQ(mesh.point[c], level.mesh().point[c]);
    }
    moved += places.offset[c] != 0;
  }
  EXPECT_GT(moved, 5);
}

}  // namespace
}  // namespace isoatlas::detail
