// SPDX-License-Identifier: Apache-2.0
// mesh_quality against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "isoatlas/error.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail {
namespace {

void add_triangle(TriangleMesh& mesh, Vec3 a, Vec3 b, Vec3 c) {
  const auto n = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c});
  mesh.triangles.push_back({n, n + 1, n + 2});
}

TEST(MeshQuality, NoTriangles) {
  const MeshQuality q = mesh_quality({});
  EXPECT_EQ(q.triangles, 0u);
  EXPECT_EQ(q.aspect_share_below_third, 0);
}

TEST(MeshQuality, ThreeFourFive) {
  TriangleMesh mesh;
  add_triangle(mesh, {0, 0, 7}, {3, 0, 7}, {0, 4, 7});
  const MeshQuality q = mesh_quality(mesh);
  EXPECT_EQ(q.triangles, 1u);
  EXPECT_DOUBLE_EQ(q.aspect_min, 0.6);
  EXPECT_DOUBLE_EQ(q.aspect_median, 0.6);
  EXPECT_DOUBLE_EQ(q.edge_min, 3);
  EXPECT_DOUBLE_EQ(q.edge_max, 5);
  EXPECT_NEAR(q.angle_max, 90, 1e-12);
  EXPECT_NEAR(q.angle_min, std::atan2(3, 4) * 180 / M_PI, 1e-12);
  EXPECT_EQ(q.zero_area_triangles, 0u);
  EXPECT_EQ(q.aspect_share_below_third, 0);
  EXPECT_EQ(q.aspect_histogram[12] + q.aspect_histogram[11], 1u);  // 0.6 is the edge of a bin
}

TEST(MeshQuality, EquilateralIsOne) {
  TriangleMesh mesh;
  add_triangle(mesh, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  const MeshQuality q = mesh_quality(mesh);
  EXPECT_NEAR(q.aspect_min, 1, 1e-15);
  EXPECT_NEAR(q.angle_min, 60, 1e-12);
  EXPECT_NEAR(q.angle_max, 60, 1e-12);
  EXPECT_EQ(q.aspect_histogram[19], 1u);  // one belongs to the last bin
}

TEST(MeshQuality, ExactlyAThirdIsNotBelow) {
  TriangleMesh mesh;  // 1, 2, 3 on a line: a third, no area, angles 0 and 180
  add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {3, 0, 0});
  const MeshQuality flat = mesh_quality(mesh);
  EXPECT_EQ(flat.aspect_share_below_third, 0);
  EXPECT_DOUBLE_EQ(flat.aspect_min, 1.0 / 3);
  EXPECT_EQ(flat.zero_area_triangles, 1u);
  EXPECT_EQ(flat.angle_min, 0);
  EXPECT_DOUBLE_EQ(flat.angle_max, 180);
  add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {3.0000001, 0, 0});
  EXPECT_EQ(mesh_quality(mesh).aspect_share_below_third, 0.5);
}

TEST(MeshQuality, CapsAreCountedByTheirAngle) {
  TriangleMesh mesh;  // edges of 1, 1 and nearly 2: an aspect ratio of a half
  add_triangle(mesh, {0, 0, 0}, {1, 1e-9, 0}, {2, 0, 0});
  add_triangle(mesh, {0, 0, 0}, {1, 0.3, 0}, {2, 0, 0});  // 146.6 degrees
  add_triangle(mesh, {0, 0, 0}, {1, 0.2, 0}, {2, 0, 0});  // 157.4 degrees
  const MeshQuality q = mesh_quality(mesh);
  EXPECT_EQ(q.angles_above_150, 2u);
  EXPECT_NEAR(q.aspect_min, 0.5, 0.03);
  EXPECT_EQ(q.zero_area_triangles, 0u);
  EXPECT_EQ(q.dihedral_min, 180) << "no two triangles share an edge";
}

TEST(MeshQuality, DihedralAnglesAreThoseInside) {
  TriangleMesh cube;
  for (int c = 0; c < 8; ++c)
    cube.positions.push_back(
        {static_cast<double>(c & 1), static_cast<double>(c >> 1 & 1), static_cast<double>(c >> 2)});
  cube.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  EXPECT_NEAR(mesh_quality(cube).dihedral_min, 90, 1e-12);
  EXPECT_NEAR(mesh_quality(cube).dihedral_max, 180, 1e-12);
  for (Triangle& t : cube.triangles)
    std::swap(t[1], t[2]);  // the boundary of a cavity: its inside surrounds it
  EXPECT_NEAR(mesh_quality(cube).dihedral_min, 180, 1e-12);
  EXPECT_NEAR(mesh_quality(cube).dihedral_max, 270, 1e-12);

  TriangleMesh roof;  // two triangles at an angle of 60 degrees, seen from above
  roof.positions = {{0, 0, 0}, {0, 1, 0}, {1, 0.5, -std::sqrt(3.0)}, {-1, 0.5, -std::sqrt(3.0)}};
  roof.triangles = {{1, 0, 2}, {0, 1, 3}};
  EXPECT_NEAR(mesh_quality(roof).dihedral_min, 60, 1e-12);
  for (Triangle& t : roof.triangles) std::swap(t[1], t[2]);  // from below: a groove
  EXPECT_NEAR(mesh_quality(roof).dihedral_max, 300, 1e-12);
}

TEST(MeshQuality, PointTriangle) {
  TriangleMesh mesh;
  add_triangle(mesh, {1, 2, 3}, {1, 2, 3}, {1, 2, 3});
  const MeshQuality q = mesh_quality(mesh);
  EXPECT_EQ(q.aspect_min, 0);
  EXPECT_EQ(q.zero_area_triangles, 1u);
  EXPECT_EQ(q.edge_max, 0);
  EXPECT_EQ(q.aspect_share_below_third, 1);
}

// 100 isosceles triangles with base k/100 and legs 1: the ratios are k/100.
TEST(MeshQuality, QuantilesAndHistogram) {
  TriangleMesh mesh;
  for (int k = 100; k >= 1; --k) {
    const double half = k / 200.0;
    add_triangle(mesh, {-half, 0, 0}, {half, 0, 0}, {0, std::sqrt(1 - half * half), 0});
  }
  const MeshQuality q = mesh_quality(mesh);
  EXPECT_NEAR(q.aspect_min, 0.01, 1e-12);
  EXPECT_GE(q.aspect_p01, 0.01 - 1e-12);
  EXPECT_LE(q.aspect_p01, 0.02 + 1e-12);
  EXPECT_NEAR(q.aspect_median, 0.505, 0.00501);
  EXPECT_NEAR(q.aspect_share_below_third, 0.33, 1e-12);
  EXPECT_EQ(std::accumulate(q.aspect_histogram.begin(), q.aspect_histogram.end(), std::size_t{0}),
            100u);
  for (int bin = 0; bin < 20; ++bin)
    EXPECT_NEAR(static_cast<double>(q.aspect_histogram[bin]), 5, 1.01) << bin;
  EXPECT_NEAR(q.edge_min, 0.01, 1e-12);
  EXPECT_NEAR(q.edge_max, 1, 1e-12);
}

TEST(MeshQuality, AspectRatioDoesNotDependOnScaleOrCornerOrder) {
  for (const double scale : {1e-3, 1.0, 1e6}) {
    const Vec3 a{0, 0, 0}, b{2 * scale, 0, 0}, c{0.3 * scale, 0.9 * scale, 0.2 * scale};
    for (const auto& order : {std::array<Vec3, 3>{a, b, c}, {b, c, a}, {c, b, a}}) {
      TriangleMesh mesh;
      add_triangle(mesh, order[0], order[1], order[2]);
      EXPECT_NEAR(mesh_quality(mesh).aspect_min, std::sqrt(0.94 / 4), 1e-12);
    }
  }
}

TEST(MeshQuality, CornerOutOfRangeIsABadArgument) {
  TriangleMesh mesh;
  mesh.positions.resize(3);
  mesh.triangles = {{0, 1, 3}};
  EXPECT_THROW(mesh_quality(mesh), Error);
}

}  // namespace
}  // namespace isoatlas::detail
