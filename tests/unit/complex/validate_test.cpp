// SPDX-License-Identifier: Apache-2.0
// validate() must detect planted faults.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using test::flat_grid;
using test::tetrahedron;
using test::tube;

TEST(Validate, AcceptsValidComplexes) {
  EXPECT_EQ(validate(tetrahedron()), "");
  EXPECT_EQ(validate(flat_grid(4, 3)), "");
  EXPECT_EQ(validate(flat_grid(2, 2)), "");
  EXPECT_EQ(validate(tube(5, 4)), "");
  EXPECT_EQ(validate(SurfaceComplex{}), "");
}

TEST(Validate, FlippedFace) {
  SurfaceComplex c = flat_grid(4, 4);
  std::swap(c.faces[4].corner[1], c.faces[4].corner[3]);
  EXPECT_NE(validate(c), "");
}

TEST(Validate, MissingFace) {
  SurfaceComplex c = flat_grid(5, 5);
  c.faces.erase(c.faces.begin() + 5);  // an inner one: its sides are boundary but not listed
  EXPECT_NE(validate(c), "");
  SurfaceComplex t = tetrahedron();
  t.faces.pop_back();
  EXPECT_NE(validate(t), "");
}

TEST(Validate, FaceTwice) {
  SurfaceComplex c = flat_grid(4, 4);
  c.faces.push_back(c.faces[0]);
  EXPECT_NE(validate(c), "");
}

TEST(Validate, BoundaryListIsWrong) {
  SurfaceComplex c = flat_grid(4, 4);
  c.boundary.pop_back();
  EXPECT_NE(validate(c), "") << "a missing side";
  c = flat_grid(4, 4);
  c.boundary.push_back(c.boundary[0]);
  EXPECT_NE(validate(c), "") << "a side twice";
  c = flat_grid(4, 4);
  std::swap(c.boundary[0].from, c.boundary[0].to);
  EXPECT_NE(validate(c), "") << "a reversed side";
  c = flat_grid(4, 4);
  c.boundary.push_back({5, 6});
  EXPECT_NE(validate(c), "") << "an inner side";
}

TEST(Validate, BoundaryFlagIsWrong) {
  SurfaceComplex c = flat_grid(4, 4);
  c.on_boundary[5] = 1;
  EXPECT_NE(validate(c), "");
  c = flat_grid(4, 4);
  c.on_boundary[0] = 0;
  EXPECT_NE(validate(c), "");
  c.on_boundary.pop_back();
  EXPECT_NE(validate(c), "");
}

TEST(Validate, CornersOutOfRangeOrRepeated) {
  SurfaceComplex c = tetrahedron();
  c.faces[1].corner[2] = 4;
  EXPECT_NE(validate(c), "");
  c = flat_grid(3, 3);
  c.faces[0].corner[2] = c.faces[0].corner[0];
  EXPECT_NE(validate(c), "");
}

TEST(Validate, CVertexInNoFace) {
  SurfaceComplex c = tetrahedron();
  c.positions.push_back({});
  c.on_boundary.push_back(0);
  EXPECT_NE(validate(c), "");
}

TEST(Validate, TwoFansAtOneCVertex) {
  SurfaceComplex c = tetrahedron();  // a second tetrahedron that shares c-vertex 3
  for (int i = 0; i < 3; ++i) {
    c.positions.push_back({});
    c.on_boundary.push_back(0);
  }
  for (const Face& f : tetrahedron().faces) {
    Face g = f;
    for (int k = 0; k < 3; ++k) g.corner[k] = f.corner[k] == 3 ? 3 : f.corner[k] + 4;
    c.faces.push_back(g);
  }
  EXPECT_NE(validate(c), "");
  // Two flat pieces that touch in a corner.
  SurfaceComplex flat = flat_grid(2, 2);
  flat.positions.resize(7);
  flat.on_boundary.assign(7, 1);
  flat.faces.push_back({{3, 4, 5, 6}});
  flat.boundary.insert(flat.boundary.end(), {{3, 4}, {4, 5}, {5, 6}, {6, 3}});
  EXPECT_NE(validate(flat), "");
}

TEST(Validate, SideThatIsAlsoADiagonal) {
  // A tube of three columns: its sides are valid, but a quad's diagonal can coincide with a side of
  // a modified face.
  SurfaceComplex c = flat_grid(3, 3);
  // Splits the first quad along 0-4 and lets a new quad use 4-0 as its diagonal.
  c.faces[0] = {{0, 1, 4, kNone}};
  c.faces.push_back({{0, 4, 3, kNone}});
  EXPECT_EQ(validate(c), "") << "cutting a quad is fine";
  // A pillow: two quads on the same four corners, so both diagonals are there twice.
  SurfaceComplex pillow;
  pillow.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  pillow.on_boundary.assign(4, 0);
  pillow.faces = {{{0, 1, 2, 3}}, {{3, 2, 1, 0}}};
  EXPECT_NE(validate(pillow), "");
  // A quad glued to two triangles that use its diagonal as a side.
  SurfaceComplex cap;
  cap.positions = pillow.positions;
  cap.on_boundary.assign(4, 0);
  cap.faces = {{{0, 1, 2, 3}}, {{2, 1, 0, kNone}}, {{3, 2, 0, kNone}}};
  EXPECT_NE(validate(cap), "");
}

TEST(Validate, TwoSidesBetweenTheSameCVertices) {
  // A tube of two columns: every ring has two sides between the same two c-vertices, once in each
  // sense.
  EXPECT_NE(validate(tube(2, 3)), "");
}

}  // namespace
}  // namespace isoatlas::detail
