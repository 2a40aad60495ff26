// SPDX-License-Identifier: Apache-2.0
// Small cases with known results; tests/property/subdivide_property_test.cpp has random volumes.
#include "embedding/subdivide.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <set>

#include "complex/components.h"
#include "core/parallel.h"
#include "core/vector_math.h"
#include "embedding/adaptive_surface.h"
#include "embedding/checked_cells.h"
#include "embedding/multi_sheet_cells.h"
#include "isoatlas/error.h"
#include "isoatlas/self_intersections.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

using Ids = std::vector<CVertexId>;

Ids all_of(const SurfaceComplex& complex) {
  Ids out(complex.c_vertex_count());
  std::iota(out.begin(), out.end(), 0u);
  return out;
}

struct Parsed {
  explicit Parsed(const Samples& samples, Vec3 spacing = {1, 1, 1},
                  Topology topology = Topology::trilinear)
      : volume(to_volume(samples, SampleType::int32, spacing)),
        field(volume.view, {0, Inside::above, NonFinite::refuse}),
        complex(surface_of(samples, 0, Inside::above, spacing, topology)),
        multi_sheet(complex, field) {}
  SurfaceInGrid in() const { return {field, multi_sheet.flags()}; }
  std::vector<Fineness> fineness() const { return isoatlas::detail::fineness(complex, in()); }
  Subdivision subdivide(const Ids& wanted) const {
    return isoatlas::detail::subdivide(complex, wanted, in());
  }
  /// Subdivides around all c-vertices. @return the complex before
  SurfaceComplex subdivide_all() {
    const SurfaceComplex before = complex;
    complex = subdivide(all_of(complex)).complex;
    return before;
  }
  AdaptiveSurface adaptive() const { return {complex, find_components(complex), {}, field}; }

  Volume volume;
  InterpolatedField field;
  SurfaceComplex complex;
  MultiSheetCells multi_sheet;
};

// 2 x 2 x 2: the surface cuts off one sample and is in one grid cell.
Samples one_corner(int corner) {
  Samples out = constant({2, 2, 2}, -1);
  out.values[static_cast<std::size_t>(corner)] = 1;
  return out;
}
// 3 x 3 x 3: the surface is a ball about the centre and has one c-vertex per grid cell.
Samples one_centre(std::int64_t inside, std::int64_t outside) {
  Samples out = constant({3, 3, 3}, outside);
  out.at(1, 1, 1) = inside;
  return out;
}
// 4 x 4 x 4: two balls about opposite corners of the grid cell (1, 1, 1), whose c-vertices there
// are 7 and 8.
Samples two_balls() {
  Samples out = constant({4, 4, 4}, -3);
  out.at(1, 1, 1) = out.at(2, 2, 2) = 1;
  return out;
}
// 3 x 3 x 2: the plane z = 0.5. Of its 4 x 4 c-vertices the 12 outer ones are on the volume's
// boundary.
Samples plane() {
  Samples out = constant({3, 3, 2}, -1);
  std::fill_n(out.values.begin(), 9, 1);
  return out;
}

Vec3 rounded_point(double x, double y, double z) { return rounded(Vec3{x, y, z}); }

void expect_positions(const SurfaceComplex& complex, CVertexId first, std::vector<Vec3> want) {
  const auto less = [](Vec3 a, Vec3 b) {
    return std::tuple(a.x, a.y, a.z) < std::tuple(b.x, b.y, b.z);
  };
  std::vector<Vec3> got(complex.positions.begin() + first, complex.positions.end());
  std::sort(got.begin(), got.end(), less);
  std::sort(want.begin(), want.end(), less);
  ASSERT_EQ(got.size(), want.size());
  for (std::size_t i = 0; i < got.size(); ++i)
    ASSERT_LT(length(got[i] - want[i]), 1e-9) << got[i].x << " " << got[i].y << " " << got[i].z;
}

bool has_only(const std::vector<Fineness>& values, Fineness want) {
  return std::all_of(values.begin(), values.end(), [&](Fineness f) { return f == want; });
}

TEST(Rounded, HasTheStatedNumberOfDigits) {
  EXPECT_EQ(rounded(0.1), std::round(0.1 * 0x1p32) * 0x1p-32);
  EXPECT_EQ(rounded(-0.1), -rounded(0.1));
  EXPECT_EQ(rounded(7), 7);
  EXPECT_EQ(rounded(0x1p17 + 0x1p-31), 0x1p17 + 0x1p-31) << "49 digits";
  EXPECT_EQ(rounded(0x1p17 + 0x1p-33), 0x1p17) << "a half, to the even one";
  EXPECT_EQ(rounded(0x1p18 + 3 * 0x1p-32), 0x1p18 + 0x1p-30);
  EXPECT_EQ(rounded(0x1p17 - 0x1p-32), 0x1p17 - 0x1p-32);
}

TEST(DisplacedPosition, IsRoundedUnlessThereIsNoDisplacement) {
  SurfaceComplex complex;
  complex.spacing = {1, 2, 4};
  complex.positions = {{0.1, 0.2, 0.3}};
  EXPECT_EQ(displaced_position(complex, 0, {}), (Vec3{0.1, 0.2, 0.3})) << "bit for bit";
  EXPECT_EQ(displaced_position(complex, 0, {1, 1, 1}), rounded_point(1.1, 0.7, 0.55));
}

TEST(HasTwoCurves, OnlyWhereSignsAlternate) {
  for (int signs = 0; signs < 16; ++signs) {
    Samples samples = constant({2, 2, 3}, -1);
    for (int k = 0; k < 4; ++k) samples.at(k % 2, k / 2, 1) = signs >> k & 1 ? 0 : -1;
    const Volume volume = to_volume(samples);
    const InterpolatedField field(volume.view, {0, Inside::above, NonFinite::refuse});
    EXPECT_EQ(has_two_curves(field, {0.3, 0.6, 1}), signs == 6 || signs == 9) << signs;
    EXPECT_FALSE(has_two_curves(field, {0.3, 0, 1.5}));
  }
}

TEST(Subdivide, ChangesNothingIfNothingIsWanted) {
  Parsed p(one_centre(1, -1));
  const Subdivision s = p.subdivide({});
  EXPECT_EQ(s.complex.positions, p.complex.positions);
  EXPECT_EQ(s.complex.face_count(), 6u);
  EXPECT_TRUE(s.origin.empty());
  const Subdivision in_place = subdivide_in_place(p.complex, {}, p.fineness(), p.in());
  EXPECT_TRUE(in_place.origin.empty() && in_place.touched.empty());
  EXPECT_EQ(p.complex.face_count(), 6u);
}

// Quads at edges of the volume are in one grid cell already: they are only split along the
// diagonal from the c-vertex inside it.
void expect_one_grid_cell(Parsed p) {
  ASSERT_EQ(p.complex.c_vertex_count(), 7u);
  ASSERT_EQ(p.complex.face_count(), 3u);
  EXPECT_TRUE(has_only(p.fineness(), Fineness::faces));
  const auto inside = static_cast<CVertexId>(
      std::find(p.complex.on_boundary.begin(), p.complex.on_boundary.end(), 0) -
      p.complex.on_boundary.begin());
  p.subdivide_all();
  EXPECT_EQ(validate(p.complex), "");
  EXPECT_EQ(p.complex.c_vertex_count(), 7u) << "none is added";
  EXPECT_EQ(p.complex.face_count(), 6u);
  EXPECT_EQ(p.complex.boundary.size(), 6u);
  for (const Face& f : p.complex.faces) {
    EXPECT_TRUE(f.is_triangle());
    EXPECT_EQ(std::count(f.corner.begin(), f.corner.end(), inside), 1);
  }
  EXPECT_TRUE(has_only(p.fineness(), Fineness::pieces));
  // Then the 12 sides are split, and each piece becomes four.
  const Subdivision s = p.subdivide(all_of(p.complex));
  EXPECT_EQ(validate(s.complex), "");
  EXPECT_EQ(s.complex.c_vertex_count(), 19u);
  EXPECT_EQ(s.complex.face_count(), 24u);
  EXPECT_EQ(s.complex.boundary.size(), 12u);
  for (CVertexId v = 7; v < 19; ++v) {
    const auto [a, b] = s.between[v - 7];
    ASSERT_LT(a, b);
    ASSERT_LT(b, 7u);
    const Vec3 at = s.complex.positions[v], p1 = p.complex.positions[a],
               p2 = p.complex.positions[b];
    EXPECT_EQ(s.complex.on_boundary[v], a != inside && b != inside);
    for (double Vec3::*x : {&Vec3::x, &Vec3::y, &Vec3::z}) {
      if (p1.*x == p2.*x && (p1.*x == 0 || p1.*x == 1)) {
        EXPECT_EQ(at.*x, p1.*x) << "stays on the wall";
      } else {
        EXPECT_GE(at.*x, kWallMargin - 0x1p-32);
        EXPECT_LE(at.*x, 1 - kWallMargin + 0x1p-32);
      }
    }
  }
}

TEST(Subdivide, OneGridCell) {
  for (int corner = 0; corner < 8; ++corner) {
    SCOPED_TRACE(corner);
    expect_one_grid_cell(Parsed(one_corner(corner)));
    expect_one_grid_cell(Parsed(negated(one_corner(corner))));
    if (HasFatalFailure()) return;
  }
}

TEST(Subdivide, FansThenPiecesThenSmallerPieces) {
  Parsed p(one_centre(1, -1));
  EXPECT_TRUE(has_only(p.fineness(), Fineness::faces));
  const Subdivision fans = p.subdivide(all_of(p.complex));
  EXPECT_EQ(validate(fans.complex), "");
  EXPECT_EQ(fans.complex.face_count(), 24u);
  expect_positions(fans.complex, 8,
                   {{1, 1, 0.5}, {1, 1, 1.5}, {1, 0.5, 1}, {1, 1.5, 1}, {0.5, 1, 1}, {1.5, 1, 1}});
  for (const auto& ends : fans.between)
    EXPECT_EQ(ends, (std::array<CVertexId, 2>{kNone, kNone})) << "nodes";
  const SurfaceComplex parsed = p.complex;
  p.complex = fans.complex;
  EXPECT_TRUE(
      std::equal(parsed.positions.begin(), parsed.positions.end(), p.complex.positions.begin()));
  EXPECT_TRUE(has_only(p.fineness(), Fineness::fans));
  const Subdivision at_node = p.subdivide({8});  // splits the sides opposite to the node
  EXPECT_EQ(validate(at_node.complex), "");
  EXPECT_EQ(fineness(at_node.complex, p.in())[8], Fineness::pieces);
  const Subdivision pieces = p.subdivide(all_of(p.complex));
  for (const auto& ends : pieces.between)
    EXPECT_EQ(ends, (std::array<CVertexId, 2>{kNone, kNone})) << "sides that cross walls";
  p.complex = pieces.complex;
  EXPECT_EQ(validate(p.complex), "");
  EXPECT_EQ(p.complex.face_count(), 48u);
  EXPECT_TRUE(has_only(p.fineness(), Fineness::pieces));
  // On a wall the field is 1 - 2 u - 2 v + 2 u v from the centre; its zero on the diagonal is at
  // 1 - sqrt(1/2). The point is three quarters of the way there from the chord's middle.
  const double d = 0.25 + 0.75 * (1 - std::sqrt(0.5) - 0.25);
  std::vector<Vec3> want;
  for (const double s : {-d, d}) {
    for (const double t : {-d, d}) {
      want.push_back({1 + s, 1 + t, 1});
      want.push_back({1 + s, 1, 1 + t});
      want.push_back({1, 1 + s, 1 + t});
    }
  }
  expect_positions(p.complex, 14, want);
  p.subdivide_all();
  EXPECT_EQ(validate(p.complex), "");
  EXPECT_EQ(p.complex.c_vertex_count(), 26u + 72u) << "one for each side";
  EXPECT_EQ(p.complex.face_count(), 4u * 48u);
}

// Around one c-vertex: its three faces become fans; the others are kept, with their ids.
TEST(Subdivide, KeepsOtherFaces) {
  const Parsed p(one_centre(1, -1));
  const Subdivision s = p.subdivide({0});
  EXPECT_EQ(validate(s.complex), "");
  EXPECT_EQ(s.complex.c_vertex_count(), 11u);
  EXPECT_EQ(s.complex.face_count(), 3u + 12u);
  expect_positions(s.complex, 8, {{1, 1, 0.5}, {1, 0.5, 1}, {0.5, 1, 1}});
  for (FaceId f = 0; f < 6; ++f) {
    const auto& was = p.complex.faces[f].corner;
    const bool is_kept = std::count(was.begin(), was.end(), 0u) == 0;
    EXPECT_EQ(s.complex.faces[f].corner == was, is_kept);
    if (!is_kept) {
      EXPECT_TRUE(s.complex.faces[f].is_triangle());
    }
  }
  for (const CVertexId origin : s.origin) EXPECT_LT(origin, 8u);
}

// All nodes are at the centre sample, which equals the isovalue. They keep 0.06 from the sample,
// and the points between them 0.03 from the edges, so that no two points coincide.
TEST(Subdivide, TieOnACorner) {
  Parsed p(one_centre(0, -1));
  const double node = 2 * kWallMargin, wall = kWallMargin;
  p.subdivide_all();
  expect_positions(p.complex, 8,
                   {{1, 1, 1 - node},
                    {1, 1, 1 + node},
                    {1, 1 - node, 1},
                    {1, 1 + node, 1},
                    {1 - node, 1, 1},
                    {1 + node, 1, 1}});
  p.subdivide_all();
  std::vector<Vec3> want;
  for (const double s : {-wall, wall}) {
    for (const double t : {-wall, wall}) {
      want.push_back({1 + s, 1 + t, 1});
      want.push_back({1 + s, 1, 1 + t});
      want.push_back({1, 1 + s, 1 + t});
    }
  }
  expect_positions(p.complex, 14, want);
  EXPECT_EQ(validate(p.complex), "");
  EXPECT_TRUE(has_only(p.fineness(), Fineness::pieces));
}

// The node on a grid edge is found with the field, also far from the middle.
TEST(Subdivide, NodesKeepTheirMargin) {
  Parsed near(one_centre(3, -1)), far(one_centre(99, -1));
  near.subdivide_all();
  far.subdivide_all();
  EXPECT_EQ(near.complex.positions[8], (Vec3{1, 1, 0.25}));
  EXPECT_EQ(far.complex.positions[8], rounded_point(1, 1, 2 * kWallMargin)) << "not 0.01";
}

// Sides next to a multi-sheet grid cell are split with the faces: the cones there are pieces at
// once.
TEST(Subdivide, MultiSheetCell) {
  const Parsed p(two_balls());
  ASSERT_EQ(p.complex.c_vertex_count(), 16u);
  const std::span<const std::uint8_t> flags = p.multi_sheet.flags();
  ASSERT_EQ(flags.size(), 16u);
  for (CVertexId v = 0; v < 16; ++v) {
    EXPECT_EQ(flags[v], v == 7 || v == 8);
    EXPECT_EQ(p.multi_sheet.contains(v), v == 7 || v == 8);
  }
  EXPECT_FALSE(p.multi_sheet.contains(16));
  EXPECT_EQ(Ids(p.multi_sheet.c_vertices_in_grid_cell_of(8).begin(),
                p.multi_sheet.c_vertices_in_grid_cell_of(8).end()),
            (Ids{7, 8}));
  const Subdivision s = p.subdivide(all_of(p.complex));
  EXPECT_EQ(validate(s.complex), "");
  EXPECT_EQ(s.complex.c_vertex_count(), 16u + 12u + 6u) << "12 nodes, 6 sides of the two";
  EXPECT_EQ(s.complex.face_count(), 48u + 12u);
  const std::vector<Fineness> now = fineness(s.complex, p.in());
  for (CVertexId v = 0; v < 16; ++v)
    EXPECT_EQ(now[v], flags[v] ? Fineness::pieces : Fineness::fans) << v;
  const double d = 0.125 + 0.75 * (1 - std::sqrt(0.75) - 0.125);
  const std::vector<Vec3> walls(s.complex.positions.begin() + 16, s.complex.positions.begin() + 22);
  SurfaceComplex on_walls;
  on_walls.positions = walls;
  expect_positions(on_walls, 0,
                   {{1, 1 + d, 1 + d},
                    {1 + d, 1, 1 + d},
                    {1 + d, 1 + d, 1},
                    {2, 2 - d, 2 - d},
                    {2 - d, 2, 2 - d},
                    {2 - d, 2 - d, 2}});
  // Without the flags the grid cell is like any other.
  const Subdivision plain = subdivide(p.complex, all_of(p.complex), {p.field, {}});
  EXPECT_EQ(plain.complex.c_vertex_count(), 28u);
}

TEST(Subdivide, VolumeBoundary) {
  const Parsed p(plane());
  ASSERT_EQ(p.complex.c_vertex_count(), 16u);
  ASSERT_EQ(p.complex.boundary.size(), 12u);
  const Subdivision s = p.subdivide(all_of(p.complex));
  EXPECT_EQ(validate(s.complex), "");
  expect_positions(s.complex, 16,
                   {{1, 0, 0.5}, {0, 1, 0.5}, {1, 1, 0.5}, {2, 1, 0.5}, {1, 2, 0.5}});
  EXPECT_EQ(s.complex.face_count(), 4u * 2 + 4u * 3 + 4u)
      << "at the volume's edges, on its faces, and inside";
  EXPECT_EQ(s.complex.boundary.size(), 16u);
  for (CVertexId v = 16; v < 21; ++v)
    EXPECT_EQ(s.complex.on_boundary[v], !(s.complex.positions[v] == Vec3{1, 1, 0.5}));
  for (std::size_t i = 0; i < 12; ++i)
    EXPECT_EQ(s.complex.boundary[i].from, p.complex.boundary[i].from) << "sides keep their index";
  // Around the c-vertex (0.5, 0): a quad at an edge of the volume, and one around a node on the
  // volume boundary.
  const auto at = static_cast<CVertexId>(
      std::find(p.complex.positions.begin(), p.complex.positions.end(), Vec3{0.5, 0, 0.5}) -
      p.complex.positions.begin());
  const Subdivision one = p.subdivide({at});
  EXPECT_EQ(validate(one.complex), "");
  expect_positions(one.complex, 16, {{1, 0, 0.5}});
  EXPECT_EQ(one.complex.face_count(), 7u + 2u + 3u);
  EXPECT_EQ(one.complex.boundary.size(), 13u);
}

// In a field without a gradient new points stay at the midpoints, so everything is known.
class InConstantField : public ::testing::Test {
 protected:
  InConstantField()
      : volume_(to_volume(constant({2, 2, 2}, 1))),
        field_(volume_.view, {0, Inside::above, NonFinite::refuse}) {}
  SurfaceComplex tetrahedron_with(std::vector<Vec3> positions) const {
    SurfaceComplex out = tetrahedron();
    out.positions = std::move(positions);
    return out;
  }
  Subdivision subdivided(const SurfaceComplex& complex, const Ids& wanted) const {
    return subdivide(complex, wanted, {field_, {}});
  }
  bool has_side(const SurfaceComplex& complex, CVertexId a, CVertexId b) const {
    return std::any_of(complex.faces.begin(), complex.faces.end(), [&](const Face& f) {
      return std::count(f.corner.begin(), f.corner.begin() + 3, a) &&
             std::count(f.corner.begin(), f.corner.begin() + 3, b);
    });
  }
  Volume volume_;
  InterpolatedField field_;
};

TEST_F(InConstantField, SplitsTheSidesAtOneCVertex) {
  const SurfaceComplex t = tetrahedron_with(
      {{0.5, 0.5, 0.875}, {0.125, 0.125, 0.125}, {0.875, 0.125, 0.125}, {0.5, 0.75, 0.125}});
  const Subdivision s = subdivided(t, {0});
  EXPECT_EQ(validate(s.complex), "");
  EXPECT_EQ(s.complex.face_count(), 3u * 3 + 1u);
  expect_positions(s.complex, 4, {{0.3125, 0.3125, 0.5}, {0.6875, 0.3125, 0.5}, {0.5, 0.625, 0.5}});
  EXPECT_EQ(s.between, (std::vector<std::array<CVertexId, 2>>{{0, 1}, {0, 2}, {0, 3}}));
  // A triangle with two split sides gets the shorter diagonal: 1 and 2 are equally far from the
  // midpoints, and 3 is nearer.
  EXPECT_TRUE(has_side(s.complex, 3, 4));
  EXPECT_TRUE(has_side(s.complex, 3, 5));
  EXPECT_FALSE(has_side(s.complex, 1, 6));
  EXPECT_FALSE(has_side(s.complex, 2, 6));
  EXPECT_NE(has_side(s.complex, 1, 5), has_side(s.complex, 2, 4)) << "a tie: one of the two";
  // Lengths are metric: with a small spacing along x the other diagonal is the shorter one.
  SurfaceComplex flat = t;
  flat.positions[3] = {0.5, 0.96875, 0.125};
  EXPECT_FALSE(has_side(subdivided(flat, {0}).complex, 1, 6));
  flat.spacing = {0.25, 1, 1};
  EXPECT_TRUE(has_side(subdivided(flat, {0}).complex, 1, 6));
}

TEST_F(InConstantField, KeepsShortSides) {
  const double tie = 0.02;
  for (const auto& [side, splits] : {std::pair{0.0199, false}, {tie, false}, {0.0201, true}}) {
    const SurfaceComplex t = tetrahedron_with(
        {{0.25, 0, 0.5}, {0.25, side, 0.5}, {0.75, 0.25, 0.25}, {0.25, 0.25, 0.875}});
    const Subdivision s = subdivided(t, all_of(t));
    EXPECT_EQ(validate(s.complex), "");
    EXPECT_EQ(s.complex.c_vertex_count(), splits ? 10u : 9u) << side;
    EXPECT_EQ(s.complex.face_count(), splits ? 16u : 14u) << side;
  }
}

// A Face whose ids are replaced by positions, from its smallest corner on.
std::vector<std::array<double, 3>> key_of(const SurfaceComplex& complex, const Face& face) {
  std::vector<std::array<double, 3>> out;
  for (int k = 0; k < face.size(); ++k) {
    const Vec3 p = complex.positions[face.corner[k]];
    out.push_back({p.x, p.y, p.z});
  }
  std::rotate(out.begin(), std::min_element(out.begin(), out.end()), out.end());
  return out;
}

auto faces_of(const SurfaceComplex& complex) {
  std::multiset<std::vector<std::array<double, 3>>> out;
  for (const Face& f : complex.faces) out.insert(key_of(complex, f));
  return out;
}

auto boundary_of(const SurfaceComplex& complex) {
  std::multiset<std::vector<std::array<double, 3>>> out;
  for (const BoundarySide& s : complex.boundary) {
    const Vec3 a = complex.positions[s.from], b = complex.positions[s.to];
    out.insert({{a.x, a.y, a.z}, {b.x, b.y, b.z}});
  }
  return out;
}

Ids some_of(const SurfaceComplex& complex, int share, Random& random) {
  Ids out;
  for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
    if (random.between(1, share) == 1) out.push_back(v);
  }
  return out;
}

template <class Check>
void for_random_surfaces(Check check) {
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    SCOPED_TRACE(seed);
    const Family family = static_cast<Family>(seed % kFamilies);
    const Samples samples = random_samples(family, {4, 5, 4}, seed);
    Parsed p(samples, seed % 2 == 0 ? Vec3{1, 1, 1} : Vec3{1, 2, 1.5});
    if (p.complex.positions.empty()) continue;
    Random random(seed + 100);
    check(p, random);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

// subdivide_in_place() subdivides only a part, with the result of subdivide() for the whole.
TEST(Subdivide, InPlaceEqualsTheWhole) {
  std::size_t replaced = 0, rounds = 0;
  for_random_surfaces([&](Parsed& p, Random& random) {
    for (int round = 0; round < 3; ++round, ++rounds) {
      const SurfaceComplex before = p.complex;
      const Ids wanted = some_of(p.complex, 4, random);
      const SurfaceComplex whole = p.subdivide(wanted).complex;
      const Subdivision s = subdivide_in_place(p.complex, wanted, p.fineness(), p.in());
      ASSERT_EQ(validate(p.complex), "");
      ASSERT_EQ(faces_of(p.complex), faces_of(whole));
      ASSERT_EQ(boundary_of(p.complex), boundary_of(whole));
      ASSERT_EQ(s.complex.face_count(), 0u);
      std::set<CVertexId> touched;
      for (FaceId f = 0; f < before.face_count(); ++f) {
        const Face &was = before.faces[f], &is = p.complex.faces[f];
        if (was.corner == is.corner) continue;
        touched.insert(was.corner.begin(), was.corner.begin() + was.size());
        ++replaced;
        ASSERT_TRUE(std::any_of(is.corner.begin(), is.corner.begin() + 3, [&](CVertexId v) {
          return std::count(was.corner.begin(), was.corner.end(), v) > 0;
        })) << "the first piece keeps the id";
      }
      ASSERT_EQ(s.touched, Ids(touched.begin(), touched.end()));
      const MeshCounts counts = count_manifold(p.complex);
      const CVertexId n = before.c_vertex_count();
      ASSERT_EQ(s.origin.size(), p.complex.c_vertex_count() - n);
      ASSERT_EQ(s.between.size(), s.origin.size());
      ASSERT_TRUE(std::equal(before.positions.begin(), before.positions.end(),
                             p.complex.positions.begin()));
      for (std::size_t i = 0; i < s.origin.size(); ++i) {
        ASSERT_LT(s.origin[i], n);
        ASSERT_EQ(counts.component_of_vertex[n + i], counts.component_of_vertex[s.origin[i]]);
        ASSERT_EQ(s.between[i][0] == kNone, s.between[i][1] == kNone);
        if (s.between[i][0] == kNone) continue;
        ASSERT_LT(std::max(s.between[i][0], s.between[i][1]), n);
      }
    }
  });
  EXPECT_GT(replaced, 1000u);
}

TEST(Subdivide, FinenessOfSomeEqualsThatOfAll) {
  std::set<Fineness> seen;
  for_random_surfaces([&](Parsed& p, Random& random) {
    for (int round = 0; round < 4; ++round) {
      const std::vector<Fineness> all = p.fineness();
      const Ids some = some_of(p.complex, 3, random);
      const std::vector<Fineness> found = fineness(p.complex, p.in(), some);
      ASSERT_EQ(found.size(), some.size());
      for (std::size_t i = 0; i < some.size(); ++i) {
        ASSERT_EQ(found[i], all[some[i]]);
        seen.insert(found[i]);
      }
      p.complex = p.subdivide(some_of(p.complex, 2, random)).complex;
    }
  });
  EXPECT_EQ(seen.size(), 3u);
}

// New points of smaller pieces stay in the grid cell, or on the wall, of their side, and are no
// farther from the surface than where they start.
TEST(Subdivide, SmallerPiecesStayInTheirGridCells) {
  std::size_t count = 0, nearer = 0;
  for_random_surfaces([&](Parsed& p, Random&) {
    p.subdivide_all();
    p.subdivide_all();
    ASSERT_TRUE(has_only(p.fineness(), Fineness::pieces));
    const Subdivision s = p.subdivide(all_of(p.complex));
    const CVertexId n = p.complex.c_vertex_count();
    for (std::size_t i = 0; i < s.between.size(); ++i, ++count) {
      ASSERT_NE(s.between[i][0], kNone);
      const Vec3 a = p.complex.positions[s.between[i][0]], b = p.complex.positions[s.between[i][1]],
                 q = s.complex.positions[n + i];
      Vec3 start;
      for (double Vec3::*x : {&Vec3::x, &Vec3::y, &Vec3::z}) {
        const double low = std::floor(std::min(a.*x, b.*x));
        if (a.*x == b.*x && a.*x == low) {
          ASSERT_EQ(q.*x, low);
          start.*x = low;
          continue;
        }
        ASSERT_LE(std::max(a.*x, b.*x), low + 1);
        ASSERT_GE(q.*x, low + kWallMargin - 0x1p-32);
        ASSERT_LE(q.*x, low + 1 - kWallMargin + 0x1p-32);
        start.*x = std::clamp((a.*x + b.*x) / 2, low + kWallMargin, low + 1 - kWallMargin);
      }
      const double was = std::abs(p.field.at(start).value), is = std::abs(p.field.at(q).value);
      ASSERT_LE(is, was * (1 + 1e-6) + 1e-6 * 1000);
      nearer += is < was / 4;
    }
  });
  EXPECT_GT(count, 5000u);
  EXPECT_GT(2 * nearer, count) << "most points are moved onto the surface";
}

TEST(Subdivide, DoesNotDependOnTheNumberOfThreads) {
  Parsed p(random_samples(Family::white_noise, {14, 14, 14}, 5));
  ASSERT_GT(p.complex.face_count(), 4096u);
  std::vector<SurfaceComplex> results;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    results.push_back(p.subdivide(all_of(p.complex)).complex);
    EXPECT_EQ(results.back().positions, results.front().positions) << threads;
    EXPECT_TRUE(std::equal(results.back().faces.begin(), results.back().faces.end(),
                           results.front().faces.begin(), results.front().faces.end(),
                           [](const Face& a, const Face& b) { return a.corner == b.corner; }));
  }
}

TEST(Subdivide, StopsWhenCancelled) {
  const Parsed p(two_balls());
  const std::atomic<bool> cancel = true;
  RunControl control;
  control.cancel = &cancel;
  const std::vector<Fineness> current = p.fineness();
  SurfaceComplex whole = p.complex;
  const SurfaceInGrid in{p.field, p.multi_sheet.flags(), &control};
  EXPECT_THROW(subdivide(p.complex, all_of(p.complex), current, in), Error);
  EXPECT_THROW(fineness(p.complex, in), Error);
  EXPECT_THROW(subdivide_in_place(whole, all_of(whole), current, in), Error);
  EXPECT_THROW(MultiSheetCells(p.complex, p.field, control), Error);
  EXPECT_THROW(AdaptiveSurface(p.complex, find_components(p.complex), {}, p.field, control), Error);
}

// Two triangles that may cross in the grid cell (0, 0, 0), and one beside them in (1, 0, 0) that
// shares no corner. Another one is on the wall x = 1 except for one corner.
class CheckedTriangles : public ::testing::Test {
 protected:
  CheckedTriangles() {
    complex_.positions = {{0.2, 0.2, 0.5}, {0.8, 0.2, 0.5}, {0.5, 0.8, 0.5},
                          {0.5, 0.4, 0.2}, {0.5, 0.4, 0.8}, {0.5, 0.5, 0.9},
                          {1.2, 0.2, 0.5}, {1.8, 0.2, 0.5}, {1.5, 0.8, 0.5}};
    complex_.on_boundary.assign(9, 1);
    complex_.faces = {{{0, 1, 2, kNone}}, {{3, 4, 5, kNone}}, {{6, 7, 8, kNone}}};
    apart_ = complex_.positions;
    apart_[3].z = 0.6;
  }
  SurfaceComplex complex_;
  std::vector<Vec3> apart_;  // the same, but the first two triangles do not intersect
};

TEST_F(CheckedTriangles, AreComparedInTheirGridCell) {
  const std::vector<GridCell> cells{{0, 0, 0}};
  const CheckedCells checked(complex_, cells);
  for (CVertexId v = 0; v < 10; ++v) EXPECT_EQ(checked.contains(v), v < 6) << v;
  Ids found = checked.intersecting(Ids{4}, complex_.positions);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  EXPECT_EQ(found, (Ids{0, 1, 2, 3, 4, 5}));
  EXPECT_TRUE(checked.intersecting(Ids{4}, apart_).empty());
  EXPECT_TRUE(checked.intersecting(Ids{6, 7, 8}, complex_.positions).empty())
      << "only the grid cells of what has moved are checked";
  EXPECT_TRUE(checked.intersecting({}, complex_.positions).empty());
  const CheckedCells none(complex_, {}), unset;
  EXPECT_FALSE(none.contains(0) || unset.contains(0));
  EXPECT_TRUE(none.intersecting(Ids{0}, complex_.positions).empty());
  EXPECT_TRUE(unset.intersecting(Ids{0}, complex_.positions).empty());
}

TEST_F(CheckedTriangles, OnlyInOneGridCell) {
  apart_ = complex_.positions;
  for (CVertexId v : {3, 4, 5})
    apart_[v].x = 1.4;  // now crosses the triangle in the next grid cell
  const std::vector<GridCell> cells{{0, 0, 0}, {1, 0, 0}};
  const CheckedCells checked(complex_, cells);
  EXPECT_TRUE(checked.contains(7));
  EXPECT_TRUE(checked.intersecting(Ids{0, 4, 7}, apart_).empty());
}

// A triangle with all corners on walls is in the grid cell of its centroid. Those with corners in
// two grid cells are in both.
TEST_F(CheckedTriangles, BelongToTheGridCellsOfTheirCorners) {
  complex_.positions[0].x = complex_.positions[0].y = 0;
  complex_.positions[1].x = 1;
  complex_.positions[2].y = 1;
  complex_.positions[5].x = 1.5;
  const std::vector<GridCell> first{{0, 0, 0}}, second{{1, 0, 0}};
  const CheckedCells in_first(complex_, first), in_second(complex_, second);
  for (CVertexId v = 0; v < 9; ++v) {
    EXPECT_EQ(in_first.contains(v), v < 6) << v;
    EXPECT_EQ(in_second.contains(v), v >= 3) << v;
  }
}

TEST(MultiSheetCells, FindIntersectingSurfels) {
  const Parsed p(two_balls());
  std::vector<Vec3> positions = p.complex.positions;
  EXPECT_TRUE(p.multi_sheet.intersecting(Ids{7, 8}, positions).empty());
  std::swap(positions[7], positions[8]);
  EXPECT_EQ(p.multi_sheet.intersecting(Ids{8}, positions), (Ids{7, 8}));
  EXPECT_TRUE(p.multi_sheet.intersecting(Ids{0, 6}, positions).empty()) << "not there";
}

TEST(MultiSheetCells, SeparateMovesCVerticesUntilNoSurfelsIntersect) {
  std::size_t cells_before = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    Parsed p(random_samples(Family::white_noise, {8, 8, 8}, seed));
    MultiSheetCells cells = p.multi_sheet;
    const Ids all = all_of(p.complex);
    for (CVertexId v = 0; v < all.size();) {  // exchanges the c-vertices of each grid cell
      if (!cells.contains(v)) {
        ++v;
        continue;
      }
      const std::size_t n = cells.c_vertices_in_grid_cell_of(v).size();
      std::reverse(p.complex.positions.begin() + v, p.complex.positions.begin() + v + n);
      v += n;
    }
    cells_before += cells.intersecting(all, p.complex.positions).size();
    std::vector<SurfaceComplex> results;
    for (const int threads : {1, 2, 8}) {
      const ThreadLimit limit(threads);
      SurfaceComplex complex = p.complex;
      EXPECT_EQ(cells.separate(complex), 0u);
      EXPECT_TRUE(cells.intersecting(all, complex.positions).empty());
      results.push_back(complex);
      EXPECT_EQ(complex.positions, results.front().positions) << threads;
    }
    for (CVertexId v = 0; v < all.size(); ++v) {
      const Vec3 was = p.complex.positions[v], is = results.front().positions[v];
      if (!cells.contains(v)) {
        ASSERT_EQ(is, was);
      }
      ASSERT_EQ(grid_cell_of(is), grid_cell_of(was));
    }
  }
  EXPECT_GT(cells_before, 10u);
}

TEST(AdaptiveSurface, StartsWithTheParsedSurface) {
  const Parsed p(one_centre(1, -2));
  const AdaptiveSurface surface = p.adaptive();
  for (CVertexId v = 0; v < 8; ++v) {
    EXPECT_EQ(surface.complex().positions[v], rounded(p.complex.positions[v]));
    EXPECT_EQ(surface.original_positions()[v], rounded(p.complex.positions[v]));
    EXPECT_TRUE(surface.is_movable(v));
  }
  EXPECT_EQ(surface.subdivision_count(), 0u);
  EXPECT_EQ(surface.added_count(), 0u);
  EXPECT_EQ(surface.max_depth(), 0);
  EXPECT_TRUE(surface.touched().empty());
}

// A multi-sheet grid cell is subdivided as a whole.
TEST(AdaptiveSurface, SubdividesMultiSheetCellsAsAWhole) {
  const Parsed p(two_balls());
  for (const CVertexId wanted : {7, 3}) {  // 3: a face around it reaches into the grid cell
    AdaptiveSurface surface = p.adaptive();
    surface.subdivide(Ids{wanted});
    const std::size_t more = wanted == 3 ? 1 : 0;
    EXPECT_EQ(validate(surface.complex()), "");
    EXPECT_EQ(surface.subdivision_count(), 2u + more);
    EXPECT_EQ(surface.added_count(), 12u + more) << "nodes of six or seven faces, and six sides";
    EXPECT_EQ(surface.max_depth(), 1);
    EXPECT_EQ(surface.complex().face_count(), 6u + 6u * 6 + 3u * more);
    Ids touched(surface.touched().begin(), surface.touched().end());
    std::sort(touched.begin(), touched.end());
    Ids want(14 + more);
    std::iota(want.begin(), want.end(), wanted == 3 ? 0u : 1u);
    EXPECT_EQ(touched, want) << "corners of replaced faces";
    for (CVertexId v = 16; v < surface.complex().c_vertex_count(); ++v) {
      const bool in_first = surface.complex().positions[v].x < 1.5;
      EXPECT_EQ(surface.components().of_c_vertex[v],
                surface.components().of_c_vertex[in_first ? 0 : 15]);
      EXPECT_EQ(surface.original_positions()[v], surface.complex().positions[v]);
    }
    surface.subdivide({});
    EXPECT_TRUE(surface.touched().empty());
    EXPECT_EQ(surface.subdivision_count(), 2u + more);
  }
}

// In the grid cell (1, 0, 2), whose field has a tunnel, two surfels are close to each other. The
// curve of one on the wall x = 1 ends at a sample equal to the isovalue: with an unrounded node it
// would leave the wall just before, and its wall point would be another one.
TEST(AdaptiveSurface, SeparatesSurfelsForTheWallPointsOfLaterSubdivisions) {
  Samples samples = constant({3, 2, 4}, -1);
  samples.values = {-1, -1, -1, -1, -1, -1,  // z = 0
                    -1, -1, 1,  0,  1,  -1,  //
                    0,  0,  1,  0,  -1, 0,   //
                    -1, 0,  -2, -1, 0,  1};
  const Parsed p(samples, {1, 1, 1}, Topology::faces);
  AdaptiveSurface surface = p.adaptive();
  for (int round = 0; round < 2; ++round) surface.subdivide(all_of(surface.complex()));
  const TriangleMesh mesh = triangles_of(surface.complex());
  EXPECT_TRUE(self_intersections(mesh.positions, mesh.triangles).empty());
}

// C-vertices around a sample of 1 among samples of -99 are within 0.01 of the walls.
TEST(AdaptiveSurface, MovesCVerticesOffWalls) {
  const Parsed p(one_centre(1, -99));
  AdaptiveSurface surface = p.adaptive();
  const std::vector<Vec3> before = surface.complex().positions;
  for (const Vec3 q : before) ASSERT_GT(std::abs(q.x - 1), 0);
  for (const Vec3 q : before) ASSERT_LT(std::abs(q.x - 1), kWallMargin);
  AdaptiveSurface fixed = surface;
  surface.subdivide(Ids{0});
  fixed.subdivide(Ids{0}, Ids{0});
  EXPECT_EQ(surface.complex().positions[0],
            rounded_point(1 - kWallMargin, 1 - kWallMargin, 1 - kWallMargin));
  EXPECT_EQ(surface.original_positions()[0], before[0]);
  EXPECT_EQ(fixed.complex().positions[0], before[0]);
  for (CVertexId v = 1; v < 8; ++v) EXPECT_EQ(surface.complex().positions[v], before[v]);
  surface.subdivide(Ids{1});
  EXPECT_EQ(surface.complex().positions[1], before[1]) << "something around it is subdivided";
}

// On edges of the volume c-vertices are fixed until the faces around them are split.
TEST(AdaptiveSurface, KeepsCVerticesOnEdgesOfTheVolume) {
  const Parsed p(plane());
  AdaptiveSurface surface = p.adaptive();
  for (CVertexId v = 0; v < 16; ++v) {
    const Vec3 q = surface.complex().positions[v];
    const bool on_edge = (q.x == 0 || q.x == 2) && (q.y == 0 || q.y == 2);
    EXPECT_EQ(surface.is_movable(v), !on_edge);
  }
  surface.subdivide(all_of(p.complex));
  for (CVertexId v = 0; v < surface.complex().c_vertex_count(); ++v)
    EXPECT_TRUE(surface.is_movable(v));
}

TEST(AdaptiveSurface, FindsConflictingMoves) {
  const Parsed p(two_balls());
  AdaptiveSurface surface = p.adaptive();
  for (int round = 0; round < 2; ++round) {  // as surfels, then as pieces in a checked grid cell
    const std::vector<Vec3> before = surface.complex().positions;
    std::vector<Vec3> positions = before;
    const Vec3 low = before[7], high = before[8];
    const auto conflicts = [&](const Ids& moved, const Ids& check) {
      std::vector<Vec3> were;
      for (const CVertexId v : moved) were.push_back(before[v]);
      const std::vector<Vec3> kept = positions;
      Ids out = surface.find_conflicting_moves(moved, were, positions, check);
      EXPECT_EQ(positions, kept) << "restored";
      std::sort(out.begin(), out.end());
      return out;
    };
    positions[7] = high;
    positions[8] = low;
    positions[0] = {0.5, 0.5, 0.5};
    EXPECT_EQ(conflicts({8, 7, 0}, {0, 7, 8}), (Ids{7, 8}));
    EXPECT_EQ(conflicts({8, 7, 0}, {}), Ids{}) << "nothing is checked";
    EXPECT_EQ(conflicts({8, 7, 0}, {0}), Ids{});
    EXPECT_EQ(conflicts({7, 0}, {7}), Ids{7}) << "only moves can be reverted";
    positions = before;
    positions[7] = {1.95, 1.95, 1.95};
    EXPECT_EQ(conflicts({7}, {7}), Ids{7});
    positions[7] = {1.3, 1.2, 1.3};
    EXPECT_EQ(conflicts({7}, {7}), Ids{});
    surface.subdivide(Ids{7});
  }
}

// The c-vertices of `before` that have other faces or another position now.
Ids changed_since(const SurfaceComplex& before, const SurfaceComplex& now) {
  using Faces = std::vector<std::set<std::array<CVertexId, 4>>>;
  const auto add = [](const SurfaceComplex& complex, Faces& out) {
    for (const Face& f : complex.faces) {
      for (int k = 0; k < f.size(); ++k) {
        if (f.corner[k] < out.size()) out[f.corner[k]].insert(f.corner);
      }
    }
  };
  Faces was(before.c_vertex_count()), is(before.c_vertex_count());
  add(before, was);
  add(now, is);
  Ids out;
  for (CVertexId v = 0; v < before.c_vertex_count(); ++v) {
    if (was[v] != is[v] || !(before.positions[v] == now.positions[v])) out.push_back(v);
  }
  return out;
}

Ids touched_by(const AdaptiveSurface& surface) {
  Ids out(surface.touched().begin(), surface.touched().end());
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

// Splitting a point on a wall into smaller pieces first splits what is in the grid cells next to
// it, in two steps. The second replaces faces of nodes that the first has added.
TEST(AdaptiveSurface, TouchedCVerticesExistedBefore) {
  AdaptiveSurface surface = Parsed(one_centre(1, -1)).adaptive();
  surface.subdivide(Ids{0});
  surface.subdivide(Ids{0});
  const SurfaceComplex before = surface.complex();
  ASSERT_EQ(before.c_vertex_count(), 8u + 3u + 3u);
  surface.subdivide(Ids{13});
  ASSERT_EQ(validate(surface.complex()), "");
  EXPECT_EQ(touched_by(surface), changed_since(before, surface.complex()));
}

TEST(AdaptiveSurface, TouchedCVerticesAreThoseThatChanged) {
  Random random(2);
  std::size_t smaller_pieces = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    const Parsed p(random_samples(static_cast<Family>(seed % kFamilies), {3, 3, 4}, seed));
    if (p.complex.positions.empty()) continue;
    AdaptiveSurface surface = p.adaptive();
    for (int round = 0; round < 4; ++round) {
      const SurfaceComplex before = surface.complex();
      const std::vector<Fineness> was = surface.fineness();
      const Ids wanted = some_of(before, round < 2 ? 3 : 20, random);
      for (const CVertexId v : wanted) smaller_pieces += was[v] == Fineness::pieces;
      surface.subdivide(wanted);
      ASSERT_EQ(validate(surface.complex()), "");
      ASSERT_EQ(touched_by(surface), changed_since(before, surface.complex()));
    }
  }
  EXPECT_GT(smaller_pieces, 5u);
}

}  // namespace
}  // namespace isoatlas::detail
