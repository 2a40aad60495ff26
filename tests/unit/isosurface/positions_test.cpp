// SPDX-License-Identifier: Apache-2.0
// Positions of c-vertices: on the surface, in the volume, on its faces if they are on the boundary,
// and all different.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/vector_math.h"
#include "isosurface/parse_surface.h"
#include "support/exact_volume.h"
#include "support/reference_topology.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

struct ValueAndSlope {
  double value, slope;
};

// The trilinear interpolant by the definition, and the length of its gradient by central
// differences.
ValueAndSlope interpolated(const Samples& s, Vec3 p) {
  const auto value = [&](double x, double y, double z) {
    const double q[3] = {x, y, z};
    std::size_t i[3];
    double t[3];
    for (int a = 0; a < 3; ++a) {
      i[a] = std::min(static_cast<std::size_t>(std::max(q[a], 0.0)), s.size[a] - 2);
      t[a] = q[a] - static_cast<double>(i[a]);
    }
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
      double w = 1;
      for (int a = 0; a < 3; ++a) w *= (c >> a & 1) ? t[a] : 1 - t[a];
      sum += w * static_cast<double>(s.at(i[0] + (c & 1), i[1] + (c >> 1 & 1), i[2] + (c >> 2)));
    }
    return sum;
  };
  constexpr double h = 1e-5;
  const Vec3 g{(value(p.x + h, p.y, p.z) - value(p.x - h, p.y, p.z)) / (2 * h),
               (value(p.x, p.y + h, p.z) - value(p.x, p.y - h, p.z)) / (2 * h),
               (value(p.x, p.y, p.z + h) - value(p.x, p.y, p.z - h)) / (2 * h)};
  return {value(p.x, p.y, p.z), length(g)};
}

bool inside_volume(Vec3 p, Size size) {
  return p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x <= size[0] - 1.0 && p.y <= size[1] - 1.0 &&
         p.z <= size[2] - 1.0;
}
bool on_volume_face(Vec3 p, Size size) {
  return p.x == 0 || p.y == 0 || p.z == 0 || p.x == size[0] - 1.0 || p.y == size[1] - 1.0 ||
         p.z == size[2] - 1.0;
}

std::vector<std::pair<std::string, Samples>> smooth_volumes() {
  return {{"sphere", sampled({24, 24, 24}, sphere({11.3, 11.6, 11.45}, 8.2))},
          {"torus", sampled({28, 28, 14}, torus({13.4, 13.6, 6.55}, 8, 3.7))},
          {"gyroid", sampled({24, 24, 24}, gyroid(12.3, 0.2))},
          {"oblique half-space", sampled({12, 13, 14}, half_space({0.51, 0.62, 0.597}, 10.1))}};
}

struct Offsets {
  double worst = 0, mean = 0;  // first-order distance from the trilinear isosurface, voxels
};
Offsets offsets(const SurfaceComplex& surface, const Samples& samples) {
  Offsets out;
  for (const Vec3& p : surface.positions) {
    const ValueAndSlope at = interpolated(samples, p);
    const double off = std::abs(at.value) / at.slope;
    out.worst = std::max(out.worst, off);
    out.mean += off / surface.c_vertex_count();
  }
  return out;
}

TEST(Positions, CVerticesLieOnTheTrilinearIsosurface) {
  for (const auto& [what, samples] : smooth_volumes()) {
    for (const Vec3 spacing : {Vec3{1, 1, 1}, Vec3{1, 2, 0.5}}) {
      const Offsets off = offsets(surface_of(samples, 0, Inside::above, spacing), samples);
      EXPECT_LT(off.worst, 0.03) << what;
      EXPECT_LT(off.mean, 0.0005) << what;
    }
  }
}

TEST(Positions, PlainAverageIsFartherOffButWithinAQuarterVoxel) {
  const Samples samples = sampled({24, 24, 24}, gyroid(7.3, 0.2));
  ParseOptions options;
  options.vertices_on_surface = false;
  const SurfaceComplex plain = parse_surface(to_volume(samples), options),
                       projected = surface_of(samples);
  EXPECT_LT(offsets(plain, samples).worst, 0.25);
  EXPECT_GT(offsets(plain, samples).mean, 20 * offsets(projected, samples).mean)
      << "the option does nothing";
  ASSERT_EQ(plain.faces.size(), projected.faces.size());
  for (std::size_t i = 0; i < plain.faces.size(); ++i)
    ASSERT_EQ(plain.faces[i].corner, projected.faces[i].corner);
}

// The plain average of nodes, computed by hand: one inside corner of a cell, nodes at 1/4 of its
// three edges.
TEST(Positions, PlainAverageByHand) {
  Samples s = constant({3, 3, 3}, -3);
  s.at(1, 1, 1) = 1;  // nodes at a quarter of the way to each of the six neighbours
  ParseOptions options;
  options.vertices_on_surface = false;
  const SurfaceComplex surface = parse_surface(to_volume(s), options);
  ASSERT_EQ(surface.c_vertex_count(), 8u);
  ASSERT_EQ(surface.face_count(), 6u);
  for (std::size_t i = 0; i < 8; ++i) {
    const double step = 0.25 / 3;
    const Vec3 want{1 + (i & 1 ? step : -step), 1 + (i & 2 ? step : -step),
                    1 + (i & 4 ? step : -step)};
    EXPECT_NEAR(length(surface.positions[i] - want), 0, 0x1p-32) << i;
  }
}

TEST(Positions, InsideTheVolumeAndBoundaryExactlyOnItsFaces) {
  std::vector<std::pair<std::string, Samples>> volumes = smooth_volumes();
  for (const KnownVolume& known : known_volumes())
    volumes.push_back(
        {known.name, plus(known.samples, -static_cast<std::int64_t>(known.isovalue))});
  for (std::uint64_t seed = 0; seed < 64; ++seed) {
    const auto family = static_cast<Family>(seed % kFamilies);
    volumes.push_back({name(family), random_samples(family, {6, 5, 7}, seed)});
    volumes.push_back({name(family), random_samples(family, {2, 5, 7}, seed)});
  }
  for (const auto& [what, samples] : volumes) {
    if (!has_surface(samples, 0)) continue;
    const SurfaceComplex surface = surface_of(samples);
    for (CVertexId v = 0; v < surface.c_vertex_count(); ++v) {
      const Vec3 p = surface.positions[v];
      ASSERT_TRUE(inside_volume(p, samples.size))
          << what << ": " << p.x << ", " << p.y << ", " << p.z;
      // C-vertices that double segments and tunnels add at nodes may lie on a face of the volume
      // without being on the boundary.
      const bool on_face = on_volume_face(p, samples.size);
      ASSERT_TRUE(surface.on_boundary[v]
                      ? on_face
                      : !on_face || surface.double_segments > 0 || surface.tunnels > 0)
          << what << ": " << p.x << ", " << p.y << ", " << p.z;
    }
  }
}

// Every boundary side lies in a face of the volume.
TEST(Positions, BoundarySidesRunWithinOneFaceOfTheVolume) {
  const Samples samples = sampled({20, 18, 22}, gyroid(9.7, 0.1));
  const SurfaceComplex surface = surface_of(samples);
  ASSERT_FALSE(surface.boundary.empty());
  for (const BoundarySide& s : surface.boundary) {
    const Vec3 a = surface.positions[s.from], b = surface.positions[s.to];
    const bool shared = (a.x == b.x && (a.x == 0 || a.x == 19)) ||
                        (a.y == b.y && (a.y == 0 || a.y == 17)) ||
                        (a.z == b.z && (a.z == 0 || a.z == 21));
    EXPECT_TRUE(shared);
  }
}

std::size_t coinciding(const SurfaceComplex& surface) {
  std::vector<std::tuple<double, double, double>> p;
  for (const Vec3& q : surface.positions) p.emplace_back(q.x, q.y, q.z);
  std::sort(p.begin(), p.end());
  std::size_t out = 0;
  for (std::size_t i = 1; i < p.size(); ++i) out += p[i] == p[i - 1];
  return out;
}

TEST(Positions, NoTwoCVerticesCoincide) {
  for (const KnownVolume& known : known_volumes())
    EXPECT_EQ(coinciding(surface_of(known.samples, known.isovalue)), 0u) << known.name;
  for (std::uint64_t seed = 0; seed < 240; ++seed) {
    const auto family = static_cast<Family>(seed % kFamilies);
    const Samples s = random_samples(family, {2 + seed % 7, 6, 5}, seed);
    for (const double isovalue : {0.0, 1.0, 0.5}) {
      if (!has_surface(s, isovalue)) continue;
      for (const Inside inside : {Inside::above, Inside::below}) {
        if (!has_surface(s, isovalue, inside)) continue;
        EXPECT_EQ(coinciding(surface_of(s, isovalue, inside)), 0u)
            << name(family) << " seed " << seed << " isovalue " << isovalue;
      }
    }
  }
}

SurfaceComplex parsed(const Samples& samples, Interpolation interpolation) {
  ParseOptions options;
  options.interpolation = interpolation;
  return parse_surface(to_volume(samples), options);
}

// The faces are the same; every c-vertex is in the same grid cell or on the same face of the
// volume boundary, and no two coincide.
TEST(Positions, TricubicInterpolationMovesPointsWithinTheirCells) {
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    const auto family = static_cast<Family>(seed % kFamilies);
    const Samples s = random_samples(family, {2 + seed % 7, 6, 5}, seed);
    if (!has_surface(s, 0)) continue;
    const SurfaceComplex linear = parsed(s, Interpolation::trilinear),
                         cubic = parsed(s, Interpolation::tricubic);
    ASSERT_EQ(validate(cubic), "");
    ASSERT_EQ(linear.faces.size(), cubic.faces.size());
    for (std::size_t i = 0; i < linear.faces.size(); ++i)
      ASSERT_EQ(linear.faces[i].corner, cubic.faces[i].corner);
    for (CVertexId v = 0; v < linear.c_vertex_count(); ++v) {
      const Vec3 p = linear.positions[v], q = cubic.positions[v];
      ASSERT_EQ(linear.on_boundary[v], cubic.on_boundary[v]);
      ASSERT_TRUE(inside_volume(q, s.size));
      const auto same_cell = [](double a, double b) {
        return std::floor(a) == std::floor(b) && std::ceil(a) == std::ceil(b);
      };
      ASSERT_TRUE(same_cell(p.x, q.x) && same_cell(p.y, q.y) && same_cell(p.z, q.z))
          << name(family) << " seed " << seed;
    }
    EXPECT_EQ(coinciding(cubic), 0u) << name(family) << " seed " << seed;
  }
}

// On a distance field only interpolation keeps c-vertices off the true sphere.
TEST(Positions, TricubicInterpolationIsNearerTheTrueSphere) {
  const Vec3 centre{13.3, 13.6, 13.45};
  const Volume volume = exact_volume({27, 28, 29}, sphere(centre, 10));
  Offsets off[2];
  for (const Interpolation interpolation : {Interpolation::trilinear, Interpolation::tricubic}) {
    ParseOptions options;
    options.interpolation = interpolation;
    const SurfaceComplex surface = parse_surface(volume, options);
    Offsets& out = off[static_cast<int>(interpolation)];
    for (const Vec3& p : surface.positions) {
      const double d = std::abs(length(p - centre) - 10);
      out.worst = std::max(out.worst, d);
      out.mean += d / surface.c_vertex_count();
    }
  }
  EXPECT_LT(off[1].worst, off[0].worst / 2);  // some are limited by the walls of their cells
  EXPECT_LT(off[1].mean, off[0].mean / 20);
  EXPECT_GT(off[0].mean, 0.005);  // 1 / (8 R) and less
}

TEST(Positions, FacesLookOutwards) {
  const SurfaceComplex ball = surface_of(sampled({20, 20, 20}, sphere({9.4, 9.6, 9.5}, 7)));
  EXPECT_NEAR(signed_volume(triangles_of(ball)), 4 * M_PI / 3 * 343, 60);
  const SurfaceComplex cavity =
      surface_of(negated(sampled({20, 20, 20}, sphere({9.4, 9.6, 9.5}, 7))));
  EXPECT_NEAR(signed_volume(triangles_of(cavity)), -4 * M_PI / 3 * 343, 60);
}

}  // namespace
}  // namespace isoatlas::detail
