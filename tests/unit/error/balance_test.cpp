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

// Of points of the surface above the mesh, weighted by area.
Distances distances(const TestLevel& level, const LevelMesh& mesh) {
  std::vector<ClosestPoint> closest;
  find_closest(level.surface_data().measured_surface(), mesh, all_of(mesh), closest);
  Distances out;
  double area = 0;
  const Surfels& surfels = level.surface_data().surfels;
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

// An inscribed mesh lies inside by about two thirds of its sagittas on average; a balanced one lies
// on both sides.
TEST(Balance, SphereIsBalanced) {
  for (const float disk : {4.0f, 8.0f}) {
    const TestLevel level(exact_surface({48, 48, 48}, sphere({23.4, 23.6, 23.55}, 20)), disk);
    LevelMesh mesh = level.mesh();
    VertexPlacement placement{level.partition().site, {}};
    const Distances before = distances(level, mesh);
    EXPECT_GT(before.signed_mean, 0.9 * before.absolute_mean) << "inscribed";
    balance(level.surface_data().measured_surface(), all_of(mesh), mesh, placement);
    const Distances after = distances(level, mesh);
    EXPECT_LT(std::abs(after.signed_mean), 0.1 * before.signed_mean);
    EXPECT_LT(after.absolute_mean, 0.6 * before.absolute_mean);
    for (const float o : placement.normal_offset) EXPECT_GE(o, -0.1f) << "outwards";
  }
}

TEST(Balance, PlaneAndBoundaryVerticesAreNotMoved) {
  const TestLevel flat(flat_grid(31, 27), 5);
  LevelMesh mesh = flat.mesh();
  VertexPlacement placement{flat.partition().site, {}};
  balance(flat.surface_data().measured_surface(), all_of(mesh), mesh, placement);
  for (CellId c = 0; c < mesh.cell_count(); ++c) {
    EXPECT_EQ(placement.normal_offset[c], 0);
    EXPECT_EQ(mesh.point[c], flat.mesh().point[c]);
  }

  const TestLevel cut(exact_surface({24, 24, 24}, sphere({11.4, 11.6, 2.55}, 9.5)), 4);
  LevelMesh cut_mesh = cut.mesh();
  VertexPlacement cut_places{cut.partition().site, {}};
  balance(cut.surface_data().measured_surface(), all_of(cut_mesh), cut_mesh, cut_places);
  int on_boundary = 0, moved = 0;
  for (CellId c = 0; c < cut_mesh.cell_count(); ++c) {
    if (cut.surface_data().graph.on_boundary[cut.partition().site[c]]) {
      ++on_boundary;
      EXPECT_EQ(cut_places.normal_offset[c], 0);
    }
    moved += cut_places.normal_offset[c] != 0;
  }
  EXPECT_GT(on_boundary, 5);
  EXPECT_GT(moved, 5);
}

// Vertices of other cells are not moved, nor are those with a neighbour that is not listed.
TEST(Balance, OnlyInnerCellsOfThoseListedAreMoved) {
  const TestLevel level(exact_surface({48, 48, 48}, sphere({23.4, 23.6, 23.55}, 20)), 6);
  LevelMesh mesh = level.mesh();
  VertexPlacement placement{level.partition().site, {}};
  std::vector<CellId> some;
  for (CellId c = 0; c < mesh.cell_count(); ++c) {
    if (mesh.point[c].z > 23) some.push_back(c);
  }
  balance(level.surface_data().measured_surface(), some, mesh, placement);
  int moved = 0;
  for (CellId c = 0; c < mesh.cell_count(); ++c) {
    bool inner = true;
    for (const std::uint32_t t : mesh.triangles_of.row(c)) {
      for (const CellId n : mesh.triangles[t]) inner = inner && level.mesh().point[n].z > 23;
    }
    if (!inner) {
      EXPECT_EQ(mesh.point[c], level.mesh().point[c]);
    }
    moved += placement.normal_offset[c] != 0;
  }
  EXPECT_GT(moved, 5);
}

}  // namespace
}  // namespace isoatlas::detail
