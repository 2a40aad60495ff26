// SPDX-License-Identifier: Apache-2.0
// Adaptive supersampling of all kinds of surface complexes: the surface stays the same, and pieces
// stay in their grid cells.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "complex/components.h"
#include "embedding/adaptive_surface.h"
#include "isosurface/isosurface.h"
#include "isosurface/parse_surface.h"
#include "optimize/relax.h"
#include "property/random_case.h"
#include "support/mesh_reference.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

struct Parsed {
  Volume volume;
  InsideRule rule;
  SurfaceComplex surface;
  InterpolatedField field;
};

// Volumes are small, because subdivided complexes are large.
Parsed parsed(RandomCase c, Interpolation interpolation = Interpolation::trilinear,
              std::uint32_t supersample = 1) {
  for (std::size_t* n : {&c.nx, &c.ny, &c.nz}) *n = 2 + (*n - 2) % 4;
  const Volume volume = to_volume(c.samples(), SampleType::int32, c.spacing);
  ParseOptions options;
  options.rule = {c.isovalue(), c.inside(), NonFinite::refuse};
  options.topology = c.seed % 2 ? Topology::trilinear : Topology::faces;
  options.interpolation = interpolation;
  options.supersample = supersample;
  return {volume, options.rule, parse_surface(volume, options),
          InterpolatedField(volume, options.rule, interpolation, supersample)};
}

// Midpoints of points in one grid cell, and midpoints of these, are exact for any length of the
// axis: long double has eleven more digits.
TEST(Rounded, MidpointsAreExact) {
  Random random(5);
  for (int i = 0; i < 100000; ++i) {
    const double start = std::ldexp(1.0 + random.unit(), static_cast<int>(random.between(-3, 31)));
    const double a = rounded(start), b = rounded(start + random.unit()), middle = (a + b) / 2,
                 next = (a + middle) / 2;
    ASSERT_EQ(static_cast<long double>(middle), (static_cast<long double>(a) + b) / 2) << start;
    ASSERT_EQ(static_cast<long double>(next), (static_cast<long double>(a) + middle) / 2) << start;
    ASSERT_NEAR(a, start, std::max(0x1p-33, start * 0x1p-49)) << start;
  }
}

RC_GTEST_PROP(AnySurface, KeepsItsTopologyWhenSubdivided, (const RandomCase& c)) {
  const Parsed p = parsed(c);
  RC_PRE(!p.surface.positions.empty());
  const InterpolatedField& field = p.field;
  const TopologySummary want = count_manifold(p.surface).topology;
  Random random(c.seed + 11);
  SurfaceComplex complex = p.surface;
  const MultiSheetCells multi_sheet(complex, field);
  for (int round = 0; round < 4; ++round) {
    std::vector<CVertexId> wanted;
    const auto share = random.between(1, 4);
    for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
      if (random.between(0, 3) < share) wanted.push_back(v);
    }
    const SurfaceInGrid in{field, multi_sheet.flags()};
    const std::vector<Fineness> was = fineness(complex, in);
    const Subdivision subdivision = subdivide(complex, wanted, in);
    RC_ASSERT(validate(subdivision.complex) == "");
    const std::uint32_t before = complex.c_vertex_count(),
                        after = subdivision.complex.c_vertex_count();
    RC_ASSERT(subdivision.origin.size() == after - before);
    for (CVertexId v = 0; v < before; ++v)
      RC_ASSERT(subdivision.complex.positions[v] == complex.positions[v]);
    const MeshCounts counts = count_manifold(subdivision.complex);
    RC_ASSERT(counts.topology == want);
    for (CVertexId v = before; v < after; ++v)
      RC_ASSERT(counts.component_of_vertex[v] ==
                counts.component_of_vertex[subdivision.origin[v - before]]);
    const std::vector<Fineness> is = fineness(subdivision.complex, in);
    for (const CVertexId v : wanted) RC_ASSERT(is[v] > was[v] || is[v] == Fineness::pieces);
    for (CVertexId v = 0; v < before; ++v) RC_ASSERT(is[v] >= was[v]);
    complex = subdivision.complex;
  }
}

// The largest distance from the isosurface of c-vertices that a first subdivision puts on faces of
// grid cells; sample-index units.
double largest_distance_on_walls(const Parsed& p) {
  AdaptiveSurface surface(p.surface, find_components(p.surface), {}, p.field);
  const Isosurface isosurface(p.volume, p.rule, p.surface);
  const CVertexId parsed = p.surface.c_vertex_count();
  double largest = 0;
  std::vector<CVertexId> all(parsed);
  std::iota(all.begin(), all.end(), 0);
  surface.subdivide(all);
  for (CVertexId v = parsed; v < surface.complex().c_vertex_count(); ++v) {
    const Vec3 q = surface.complex().positions[v];
    const int whole =
        (q.x == std::floor(q.x)) + (q.y == std::floor(q.y)) + (q.z == std::floor(q.z));
    if (whole == 1) largest = std::max(largest, isosurface.distance(q, 0));
  }
  return largest;
}

// A sample equal to the isovalue at a corner that a curve cuts off: the curve is at that corner,
// not at the other one on this wall.
TEST(Subdivide, PointOnAWallIsNearTheCurveOfItsNodesWhereASampleEqualsTheIsovalue) {
  const Volume volume = to_volume({{2, 2, 3}, {0, -15, -24, 6, 0, -15, -24, 6, 0, -15, -24, 6}});
  const InsideRule rule{0, Inside::above, NonFinite::refuse};
  ParseOptions options;
  options.rule = rule;
  EXPECT_LT(largest_distance_on_walls(
                {volume, rule, parse_surface(volume, options), InterpolatedField(volume, rule)}),
            0.25);
}

// Noise with samples equal to the isovalue, at most one per wall: on a plateau the position of the
// surface is undefined.
TEST(Subdivide, PointsOnWallsAreNearTheIsosurface) {
  Random random(14);
  const InsideRule rule{0, Inside::above, NonFinite::refuse};
  ParseOptions options;
  options.rule = rule;
  for (int i = 0; i < 300; ++i) {
    Samples noise = random_samples(Family::white_noise, {4, 4, 4}, random.between(0, 1 << 20));
    for (std::size_t z = 0; z < 4; z += 2) {
      for (std::size_t y = 0; y < 4; y += 2) {
        for (std::size_t x = 0; x < 4; x += 2) noise.at(x, y, z) *= random.between(0, 1);
      }
    }
    const Volume volume = to_volume(noise);
    ASSERT_LT(largest_distance_on_walls(
                  {volume, rule, parse_surface(volume, options), InterpolatedField(volume, rule)}),
              0.3)
        << i;
  }
}

// For any positions of the c-vertices in their grid cells.
void subdivided_everywhere_has_no_self_intersections(const Parsed& p, std::uint64_t seed) {
  AdaptiveSurface surface(p.surface, find_components(p.surface), {}, p.field);
  Random random(seed + 3);
  const auto rounds = random.between(1, 3);
  for (int round = 0; round < rounds; ++round) {
    const SurfaceComplex& complex = surface.complex();
    std::vector<CVertexId> moved;
    std::vector<Vec3> positions = complex.positions;
    for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
      if (!surface.is_movable(v) || random.between(0, 2) == 0) continue;
      const MoveBounds bounds = move_bounds_of(complex.positions[v], {1, 1, 1});
      const auto between = [&](double low, double high) {
        return low + random.unit() * (high - low);
      };
      positions[v] = {between(bounds.low.x, bounds.high.x), between(bounds.low.y, bounds.high.y),
                      between(bounds.low.z, bounds.high.z)};
      moved.push_back(v);
    }
    std::vector<Vec3> before;
    for (const CVertexId v : moved) before.push_back(complex.positions[v]);
    const std::vector<Vec3> as_moved = positions;
    const std::vector<CVertexId> conflicting_moves =
        surface.find_conflicting_moves(moved, before, positions, moved);
    RC_ASSERT(positions == as_moved);
    for (const CVertexId v : conflicting_moves) positions[v] = complex.positions[v];
    for (const CVertexId v : moved) surface.move(v, positions[v]);
    std::vector<CVertexId> wanted;
    const std::vector<Fineness> now = surface.fineness();
    for (CVertexId v = 0; v < now.size(); ++v) {
      if (now[v] == Fineness::faces || (round > 0 && random.between(0, 3) == 0))
        wanted.push_back(v);
    }
    surface.subdivide(wanted);
    RC_ASSERT(check_embedding(triangles_of(surface.complex())).pairs == 0u);
  }
}

RC_GTEST_PROP(AnySurface, SubdividedEverywhereHasNoSelfIntersections, (const RandomCase& c)) {
  const Parsed p = parsed(c);
  RC_PRE(!p.surface.positions.empty());
  subdivided_everywhere_has_no_self_intersections(p, c.seed);
}

RC_GTEST_PROP(AnySurface, SubdividedEverywhereHasNoSelfIntersectionsTricubicOrSupersampled,
              (const RandomCase& c)) {
  const auto interpolation = c.seed % 3 == 0 ? Interpolation::trilinear : Interpolation::tricubic;
  const auto supersample =
      static_cast<std::uint32_t>(c.seed % 3 == 0 ? 2 + c.seed % 2 : 1 + c.seed / 3 % 3);
  const Parsed p = parsed(c, interpolation, supersample);
  RC_PRE(!p.surface.positions.empty());
  subdivided_everywhere_has_no_self_intersections(p, c.seed);
}

}  // namespace
}  // namespace isoatlas::detail
