// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "core/vector_math.h"
#include "error/measure_mesh.h"
#include "isoatlas/error.h"
#include "isoatlas/extract.h"
#include "isosurface/parse_surface.h"
#include "support/exact_volume.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using test::exact_volume;
using test::exact_volume_on;

constexpr double kDegrees = std::numbers::pi / 180;

/// A sphere of rings, from one pole to the polar angle `end`; facing outward.
TriangleMesh uv_sphere(Vec3 c, double radius, std::uint32_t rings, double end = std::numbers::pi) {
  TriangleMesh mesh;
  const std::uint32_t n = 2 * rings;
  for (std::uint32_t i = 0; i <= rings; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const double polar = end * i / rings, around = 2 * std::numbers::pi * j / n;
      mesh.positions.push_back(c + radius * Vec3{std::sin(polar) * std::cos(around),
                                                 std::sin(polar) * std::sin(around),
                                                 std::cos(polar)});
    }
  }
  for (std::uint32_t i = 0; i < rings; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * n + j, b = i * n + (j + 1) % n, d = a + n, e = b + n;
      if (i > 0) mesh.triangles.push_back({a, d, b});
      if (i + 1 < rings || end < 3) mesh.triangles.push_back({b, d, e});
    }
  }
  return mesh;
}

/// A square of 2 x 2 triangles per unit about c, spanned by u and v, facing along their cross
/// product.
TriangleMesh square(Vec3 c, Vec3 u, Vec3 v, std::uint32_t n) {
  TriangleMesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i)
      mesh.positions.push_back(c + ((2.0 * i / n - 1) * u + (2.0 * j / n - 1) * v));
  }
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i;
      mesh.triangles.push_back({a, a + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  }
  return mesh;
}

TriangleMesh extracted(const VolumeView& volume, Space space, double max_radius) {
  ExtractOptions options = test::coarse_options();
  options.space = space;
  options.covering.max_radius = max_radius;
  return extract(volume, options).mesh();
}

TEST(Measure, SphereOfAnotherRadius) {
  const Vec3 c{20.3, 20.6, 20.45};
  const double radius = 14.2;
  const Volume volume = exact_volume({42, 42, 42}, test::sphere(c, radius));
  for (const double r : {13.2, 14.2, 15.0, 17.2}) {
    const TriangleMesh mesh = uv_sphere(c, r, 60);
    const Measurement m = measure(mesh, volume, {.space = Space::voxel, .samples = 20000});
    const double d = std::abs(r - radius),
                 error = 0.03;  // trilinear: 1 / (8 R); the mesh's chords: 0.01
    for (const OneSidedDistance* side : {&m.mesh_to_surface, &m.surface_to_mesh}) {
      EXPECT_NEAR(side->maximum, d, error);
      EXPECT_NEAR(side->mean, d, error);
      EXPECT_NEAR(side->root_mean_square, d, error);
      EXPECT_NEAR(side->p50, d, error);
      EXPECT_NEAR(side->p99, d, error);
      EXPECT_LE(side->p50, side->p99);
      EXPECT_LE(side->p99, side->maximum);
      EXPECT_GT(side->samples, 20000u);
    }
    EXPECT_NEAR(m.mesh_area, 4 * std::numbers::pi * r * r, 3);
    EXPECT_NEAR(m.surface_area, 4 * std::numbers::pi * radius * radius, 12);
    EXPECT_NEAR(m.mesh_to_surface.samples_per_voxel_face, 20000 / m.mesh_area, 1e-9);
    EXPECT_LT(m.normal_mean, 2);
    EXPECT_LT(m.normal_maximum, 8);
    EXPECT_EQ(m.voxel, 1);
  }
}

TEST(Measure, HalfASphereIsFarFromTheOtherHalf) {
  const Vec3 c{16.3, 16.6, 16.45};
  const double radius = 11.7;
  const Volume volume = exact_volume({34, 34, 34}, test::sphere(c, radius));
  const TriangleMesh mesh = uv_sphere(c, radius, 60, std::numbers::pi / 2);
  const Measurement m = measure(mesh, volume, {.space = Space::voxel, .samples = 50000});
  EXPECT_LT(m.mesh_to_surface.maximum, 0.04);
  // Every point is closest to the equator. The distance of the pole is the chord of a quarter
  // circle; samples near it are little less far.
  EXPECT_NEAR(m.surface_to_mesh.maximum, radius * std::numbers::sqrt2, 0.3);
  EXPECT_NEAR(m.surface_to_mesh.farthest.z, c.z - radius, 0.05);
  // The mean over the lower half of the chord 2 R sin(t / 2), t the angle from the equator, is 4/3
  // (sqrt 2 - 1) R.
  EXPECT_NEAR(m.surface_to_mesh.mean, radius * 4 / 3 * (std::numbers::sqrt2 - 1) / 2, 0.05);
  EXPECT_LT(m.surface_to_mesh.p50, 0.2);
  EXPECT_EQ(m.maximum(), m.surface_to_mesh.maximum);
  EXPECT_EQ(m.mean(), m.surface_to_mesh.mean);
  EXPECT_EQ(m.p99(), m.surface_to_mesh.p99);
}

// A plane at an offset and a tilted one, in grids of any spacing, orientation and origin, sheared
// and mirrored, in every space: the results are the same.
TEST(Measure, PlanesInAnyGridAndSpace) {
  const double turn = 0.4, c = std::cos(turn), s = std::sin(turn);
  std::vector<Grid> grids(5);
  grids[1].spacing = {0.7, 1.3, 2};
  grids[2].spacing = {2.5e-7, 1e-7, 2e-7};
  grids[2].origin = {3e-5, -1e-5, 0};
  grids[3].spacing = {3, 2, 2.5};
  grids[3].direction = {Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, 1}};
  grids[3].origin = {-120, 310, 45};
  grids[4] = grids[3];
  grids[4].direction[2] = {0, 0, -1};  // mirrored
  for (std::size_t g = 0; g < grids.size(); ++g) {
    Grid& grid = grids[g];
    grid.size = {24, 25, 26};
    const double voxel = grid.smallest_spacing();
    const Vec3 centre = grid.to_world({11.4, 12.3, 12.7}), n = normalized({0.3, -0.5, 0.8});
    const Volume volume = exact_volume_on(grid, [&](double x, double y, double z) {
      return dot(n, centre - grid.to_world({x, y, z}));
    });
    const Vec3 u = normalized(cross(n, {1, 0, 0})), v = cross(n, u);
    for (const Space space : {Space::lps, Space::ras, Space::voxel}) {
      const auto in_space = [&](TriangleMesh mesh) {
        for (Vec3& p : mesh.positions) {
          if (space == Space::ras) p = {-p.x, -p.y, p.z};
          if (space == Space::voxel) p = grid.to_index(p);
        }
        if (space == Space::voxel && grid.mirrored()) {
          for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
        }
        return mesh;
      };
      const MeasureOptions options{.space = space, .samples = 5000};
      for (const double offset : {0.0, 0.25, -1.5}) {
        const TriangleMesh mesh =
            in_space(square(centre + (offset * voxel) * n, (4 * voxel) * u, (4 * voxel) * v, 4));
        const Measurement m = measure(mesh, volume, options);
        EXPECT_NEAR(m.mesh_to_surface.maximum, std::abs(offset) * voxel, 1e-6 * voxel) << g;
        EXPECT_NEAR(m.mesh_to_surface.mean, std::abs(offset) * voxel, 1e-6 * voxel);
        EXPECT_NEAR(m.mesh_area, 64 * voxel * voxel, 1e-9 * voxel * voxel);
        EXPECT_LT(m.normal_maximum, 1e-5) << g << " " << static_cast<int>(space);
        EXPECT_EQ(m.voxel, voxel);
        EXPECT_GT(m.surface_to_mesh.maximum, 2 * voxel);  // the mesh is only a part of the surface
      }
      const double tilt = 10 * kDegrees;
      const Vec3 tilted = std::cos(tilt) * u + std::sin(tilt) * n;
      const Measurement m = measure(
          in_space(square(centre, (4 * voxel) * tilted, (4 * voxel) * v, 4)), volume, options);
      EXPECT_NEAR(m.normal_mean, 10, 1e-5);
      EXPECT_NEAR(m.normal_p99, 10, 1e-5);
      EXPECT_NEAR(m.normal_maximum, 10, 1e-5);
      EXPECT_NEAR(m.mesh_to_surface.maximum, 4 * voxel * std::sin(tilt), 1e-5 * voxel);
      EXPECT_NEAR(m.mesh_to_surface.mean, 2 * voxel * std::sin(tilt), 2e-3 * voxel);
      EXPECT_NEAR(m.mesh_to_surface.root_mean_square, 4 / std::sqrt(3) * voxel * std::sin(tilt),
                  2e-3 * voxel);
      const Vec3 far = space == Space::voxel ? grid.to_world(m.mesh_to_surface.farthest)
                       : space == Space::ras
                           ? Vec3{-m.mesh_to_surface.farthest.x, -m.mesh_to_surface.farthest.y,
                                  m.mesh_to_surface.farthest.z}
                           : m.mesh_to_surface.farthest;
      EXPECT_NEAR(std::abs(dot(far - centre, tilted)), 4 * voxel, 1e-6 * voxel);
    }
  }
}

TEST(Measure, InvertedTrianglesAndTheOtherInside) {
  const Volume volume =
      exact_volume({12, 12, 12}, test::half_space({0, 0, 1}, 5.5));  // outside is up
  TriangleMesh mesh = square({5, 5, 5.5}, {3, 0, 0}, {0, 3, 0}, 2);
  const auto angle = [&](Inside inside) {
    return measure(mesh, volume,
                   {.surface = {.inside = inside}, .space = Space::voxel, .samples = 100})
        .normal_mean;
  };
  EXPECT_NEAR(angle(Inside::above), 0, 1e-6);
  EXPECT_NEAR(angle(Inside::below), 180, 1e-6);
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_NEAR(angle(Inside::above), 180, 1e-6);
}

TEST(Measure, SpikesAreFoundByVerticesAndMidpoints) {
  const Volume volume = exact_volume({24, 24, 24}, test::half_space({0, 0, 1}, 5.5));
  TriangleMesh mesh = square({11, 11, 5.5}, {9, 0, 0}, {0, 9, 0}, 3);
  const auto n = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(),
                        {{11, 11, 5.5}, {11, 11.000001, 5.5}, {11, 11, 12.5}});
  mesh.positions.push_back({0, 0, 1000});  // in no triangle
  mesh.triangles.push_back({n, n + 1, n + 2});
  const Measurement m = measure(mesh, volume, {.space = Space::voxel, .samples = 1000});
  EXPECT_NEAR(m.mesh_to_surface.maximum, 7, 1e-6);
  EXPECT_NEAR(m.mesh_to_surface.farthest.z, 12.5, 1e-12);
  EXPECT_LT(m.mesh_to_surface.p99, 1e-6);
  // 1000 spread by area; 19 triangles, 33 + 3 edges, 16 + 3 vertices.
  EXPECT_EQ(m.mesh_to_surface.samples, 1000u + 19 + 36 + 19);
}

TEST(Measure, SameBytesForAnyNumberOfThreads) {
  const Volume volume =
      test::to_volume(test::random_samples(test::Family::smooth_blobs, {24, 25, 26}, 3));
  const TriangleMesh coarse = extracted(volume, Space::voxel, 4);
  const auto run = [&](int threads) {
    RunControl control;
    control.threads = threads;
    return measure(coarse, volume, {.space = Space::voxel, .samples = 30000}, control);
  };
  const Measurement one = run(1);
  EXPECT_GT(one.mesh_to_surface.maximum, 0);
  for (const int threads : {2, 3}) {
    const Measurement other = run(threads);
    EXPECT_EQ(std::memcmp(&one, &other, sizeof one), 0);
  }
}

TEST(Measure, SameResultWithAGivenIsosurface) {
  Volume volume = test::to_volume(test::random_samples(test::Family::smooth_blobs, {20, 20, 20}, 4),
                                  SampleType::int32, {2, 2, 4});
  const TriangleMesh mesh = extracted(volume, Space::voxel, 100);
  const Measurement outer = measure(mesh, volume, {.space = Space::voxel, .samples = 4000});
  const InsideRule rule{0, Inside::above, NonFinite::refuse};
  const Isosurface surface(volume, rule, parse_surface(volume, {rule, true}));
  const Measurement inner = measure(mesh, surface, 4000);
  EXPECT_EQ(inner.voxel, 2);
  EXPECT_NEAR(inner.maximum(), outer.maximum(), 1e-9);
  EXPECT_NEAR(inner.mean(), outer.mean(), 1e-9);
  EXPECT_NEAR(inner.surface_area, outer.surface_area, 1e-9 * outer.surface_area);
  EXPECT_EQ(inner.mesh_to_surface.samples, outer.mesh_to_surface.samples);
}

TEST(Measure, CoarseMeshesAreFartherThanFineOnes) {
  const Volume volume = exact_volume({40, 40, 40}, test::torus({19.4, 19.6, 19.55}, 11, 5));
  double before = 0;
  for (const double radius : {1.0, 3.0, 10.0}) {
    const Measurement m =
        measure(extracted(volume, Space::lps, radius), volume, {.samples = 20000});
    EXPECT_GT(m.mean(), before);
    EXPECT_LT(m.surface_to_mesh.p50, m.surface_to_mesh.maximum);
    before = m.mean();
  }
}

void expect_error(ErrorCode code, const char* part, const TriangleMesh& mesh,
                  const VolumeView& volume, const MeasureOptions& options,
                  const RunControl& control = {}) {
  try {
    measure(mesh, volume, options, control);
    ADD_FAILURE() << "no error: " << part;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Measure, Errors) {
  const Volume volume = exact_volume({8, 8, 8}, test::half_space({0, 0, 1}, 3.5));
  const TriangleMesh good = square({4, 4, 3.5}, {1, 0, 0}, {0, 1, 0}, 1);
  expect_error(ErrorCode::bad_argument, "no triangles", {good.positions, {}}, volume, {});
  expect_error(ErrorCode::bad_argument, "vertex 99", {good.positions, {{0, 1, 99}}}, volume, {});
  expect_error(ErrorCode::bad_argument, "samples", good, volume, {.samples = 0});
  expect_error(ErrorCode::bad_argument, "isovalue", good, volume,
               {.surface = {.isovalue = std::nan("")}});
  expect_error(ErrorCode::empty_surface, "range from", good, volume,
               {.surface = {.isovalue = 1e9}});
  Volume sheared = volume;
  sheared.view.grid.direction[1] = {0.6, 0.8, 0};
  expect_error(ErrorCode::unsupported, "sheared", good, sheared, {});
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e20, -1e300}) {
    TriangleMesh mesh = good;
    mesh.positions[2].y = bad;
    expect_error(ErrorCode::bad_argument, "vertex 2", mesh, volume, {});
  }
  Volume flat = volume;
  flat.view.grid.size = {512, 1, 1};
  expect_error(ErrorCode::bad_argument, "1 samples along y", good, flat, {});
  flat = volume;
  flat.view.grid.direction[1] = flat.view.grid.direction[0];
  expect_error(ErrorCode::bad_argument, "plane", good, flat, {});
  const std::atomic<bool> stop{true};
  RunControl control;
  control.cancel = &stop;
  expect_error(ErrorCode::cancelled, "", good, volume, {}, control);
  const Volume holes = test::own<float>(volume.view.grid, SampleType::float32,
                                        std::vector<float>(512, std::nanf("")));
  expect_error(ErrorCode::unsupported, "NaN", good, holes, {});
}

TEST(Measure, FarAndDegenerateMeshes) {
  const Volume volume = exact_volume({8, 8, 8}, test::half_space({0, 0, 1}, 3.5));
  const TriangleMesh far = square({4, 4, 1e12}, {1, 0, 0}, {0, 1, 0}, 2);
  const Measurement m = measure(far, volume, {.samples = 100});
  EXPECT_NEAR(m.mesh_to_surface.maximum, 1e12, 1e3);
  EXPECT_NEAR(m.surface_to_mesh.maximum, 1e12, 1e3);
  const TriangleMesh point{{{4, 4, 5.5}}, {{0, 0, 0}}};
  const Measurement p = measure(point, volume, {.samples = 100});
  EXPECT_NEAR(p.mesh_to_surface.mean, 2, 1e-9);
  EXPECT_EQ(p.normal_maximum, 0);
  EXPECT_EQ(p.mesh_area, 0);
  EXPECT_NEAR(p.surface_to_mesh.maximum, std::hypot(4, 4, 2), 1e-9);
}

}  // namespace
}  // namespace isoatlas::detail
