// SPDX-License-Identifier: Apache-2.0
#include "isosurface/isosurface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/vector_math.h"
#include "isosurface/parse_surface.h"
#include "support/exact_volume.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using test::exact_volume;
using test::Random;

Isosurface isosurface_of(const VolumeView& volume, double isovalue = 0) {
  const InsideRule rule{isovalue, Inside::above, NonFinite::refuse};
  return {volume, rule, parse_surface(volume, {rule, true})};
}

Vec3 random_in(Random& random, Vec3 low, Vec3 high) {
  return {low.x + random.unit() * (high.x - low.x), low.y + random.unit() * (high.y - low.y),
          low.z + random.unit() * (high.z - low.z)};
}

TEST(Isosurface, PlaneIsExactInAnyMetric) {
  for (const Vec3 spacing : {Vec3{1, 1, 1}, Vec3{1, 2.5, 1.25}, Vec3{0.01, 0.03, 0.02}}) {
    const Vec3 n = normalized({0.3, -0.5, 0.8});  // metric
    const double offset = dot(n, to_metric({9, 10, 11}, spacing));
    const Volume volume = exact_volume(
        {20, 21, 22},
        [&](double x, double y, double z) {
          return offset - dot(n, to_metric({x, y, z}, spacing));
        },
        spacing);
    const Isosurface surface = isosurface_of(volume);
    Random random(5);
    const double voxel = std::min({spacing.x, spacing.y, spacing.z});
    for (int k = 0; k < 300; ++k) {
      // Points whose closest point of the plane is well inside the volume.
      const Vec3 p = random_in(random, {8, 9, 10}, {10, 11, 12});
      const double d = dot(n, to_metric(p, spacing)) - offset;
      const Isosurface::Hit hit = surface.closest(p);
      EXPECT_NEAR(hit.distance, std::abs(d), 1e-6 * std::abs(d) + 1e-9 * voxel);
      EXPECT_LT(length(to_metric(p - hit.point, spacing) - d * n),
                2e-3 * std::abs(d) + 1e-9 * voxel);
      EXPECT_LT(length(surface.normal(hit.point) - n), 1e-9);
      EXPECT_NEAR(surface.closest_on_faces(p).distance, std::abs(d),
                  4e-3 * voxel);  // nodes keep a distance from the samples
      const auto on = surface.onto_surface(hit.point + 0.1 * Vec3{1, 1, 1});
      ASSERT_TRUE(on);
      EXPECT_NEAR(dot(n, to_metric(*on, spacing)), offset, 1e-6 * voxel);
    }
  }
}

TEST(Isosurface, SphereFromFarAndNear) {
  const Vec3 c{15.3, 15.6, 15.45};
  const Volume volume = exact_volume({32, 32, 32}, test::sphere(c, 9.2));
  const Isosurface surface = isosurface_of(volume);
  Random random(6);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 p = random_in(random, {0, 0, 0}, {31, 31, 31});
    const double r = length(p - c);
    if (r < 1) continue;
    const Isosurface::Hit hit = surface.closest(p);
    EXPECT_NEAR(hit.distance, std::abs(r - 9.2), 0.03);  // trilinear error: 1/(8 R) at most
    EXPECT_NEAR(length(hit.point - p), hit.distance, 1e-12);
    EXPECT_GT(dot(surface.normal(hit.point), normalized(hit.point - c)), 0.995);
    EXPECT_LE(hit.distance, surface.closest_on_faces(p).distance + 0.06);
  }
}

TEST(Isosurface, OfATricubicFieldIsNearerTheTrueSphere) {
  const Vec3 c{15.3, 15.6, 15.45};
  const Volume volume = exact_volume({32, 32, 32}, test::sphere(c, 10));
  const InsideRule rule{0, Inside::above, NonFinite::refuse};
  ParseOptions parse;
  parse.interpolation = Interpolation::tricubic;
  const SurfaceComplex complex = parse_surface(volume, parse);
  const Isosurface linear(volume, rule, parse_surface(volume, {rule, true})),
      cubic(volume, rule, complex, Interpolation::tricubic);
  Random random(6);
  double off[2] = {0, 0};
  for (int k = 0; k < 2000; ++k) {
    const Vec3 p = random_in(random, {4, 4, 4}, {27, 27, 27});
    const double r = length(p - c);
    if (r < 5) continue;
    const auto miss = [&](const Isosurface& surface) {
      return std::abs(surface.closest(p).distance - std::abs(r - 10));
    };
    off[0] += miss(linear);
    off[1] += miss(cubic);
    EXPECT_LT(length(cubic.normal(cubic.closest(p).point) - (1 / r) * (p - c)), 0.03);
  }
  EXPECT_LT(off[1], off[0] / 20);
  // The intersections with grid edges.
  double worst[2] = {0, 0};
  int crossed = 0;
  for (int k = 0; k < 3000; ++k) {
    Vec3 low = random_in(random, {3, 3, 3}, {28, 28, 28});
    low = {std::floor(low.x), std::floor(low.y), std::floor(low.z)};
    const auto a = linear.on_edge(low, k % 3), b = cubic.on_edge(low, k % 3);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a) continue;
    ++crossed;
    worst[0] = std::max(worst[0], std::abs(length(*a - c) - 10));
    worst[1] = std::max(worst[1], std::abs(length(*b - c) - 10));
  }
  EXPECT_GT(crossed, 50);
  EXPECT_LT(worst[1], worst[0] / 5);
}

// Points of the trilinear surface: its intersections with lines parallel to the axes.
std::vector<Vec3> crossings(const InterpolatedField& field, int lines_per_cell) {
  std::vector<Vec3> out;
  const Vec3 last = field.last();
  const double ends[3] = {last.x, last.y, last.z};
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int i = 0; i <= lines_per_cell * ends[u]; ++i) {
      for (int j = 0; j <= lines_per_cell * ends[v]; ++j) {
        const double s = static_cast<double>(i) / lines_per_cell,
                     t = static_cast<double>(j) / lines_per_cell;
        const auto at = [&](double w) {
          double p[3];
          p[axis] = w, p[u] = s, p[v] = t;
          return Vec3{p[0], p[1], p[2]};
        };
        for (int cell = 0; cell < static_cast<int>(ends[axis]);
             ++cell) {  // linear along the line within a cell
          const double a = field.at(at(cell)).value, b = field.at(at(cell + 1)).value;
          if ((a >= 0) != (b >= 0)) out.push_back(at(cell + a / (a - b)));
        }
      }
    }
  }
  return out;
}

TEST(Isosurface, NoiseAgainstManyPointsOfTheSurface) {
  double excess = 0;
  int queries = 0, far = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Volume volume =
        test::to_volume(test::random_samples(test::Family::white_noise, {6, 6, 6}, seed));
    const Isosurface surface = isosurface_of(volume, 0.5);
    const InterpolatedField field(volume, {0.5, Inside::above, NonFinite::refuse});
    const std::vector<Vec3> cloud = crossings(field, 25);
    Random random(seed);
    for (int k = 0; k < 150; ++k) {
      const Vec3 p = random_in(random, {-1, -1, -1}, {6, 6, 6});
      double slow = INFINITY;
      for (const Vec3& q : cloud) slow = std::min(slow, length(p - q));
      const Isosurface::Hit hit = surface.closest(p);
      ASSERT_TRUE(hit.found());
      const InterpolatedField::Value at = field.at(hit.point);
      EXPECT_LE(std::abs(at.value), 1e-4 * length(at.gradient)) << "not on the surface";
      EXPECT_GE(hit.distance, slow - 0.03);
      EXPECT_LE(hit.distance, slow + 0.5);
      excess += std::max(0.0, hit.distance - slow);
      far += hit.distance > slow + 0.05;
      ++queries;
    }
  }
  EXPECT_LT(excess / queries, 0.01);
  EXPECT_LT(far, queries / 20);
}

TEST(Isosurface, EndsAtTheVolumeBoundary) {
  const Volume volume = exact_volume({8, 8, 8}, test::half_space({0.6, 0, 0.8}, 5.1));
  const Isosurface surface = isosurface_of(volume);
  // Outside the volume: the closest point is on the volume boundary, in line with the surface
  // there.
  for (const double beyond : {0.01, 0.5, 3.0, 40.0}) {
    const Isosurface::Hit hit = surface.closest({4.5, 7 + beyond, 3});
    EXPECT_NEAR(hit.distance, beyond, 1e-9);
    EXPECT_NEAR(hit.point.y, 7, 1e-12);
    const Isosurface::Hit off = surface.closest({4.5 + 0.6, -beyond, 3 + 0.8});
    EXPECT_NEAR(off.distance, std::hypot(beyond, 1), 1e-5);
    EXPECT_NEAR(off.point.x, 4.5, 2e-3 * (1 + beyond));
  }
  // The plane leaves through a slanted edge: z = 0 at x = 8.5 is outside, x = 7 at z = 1.125 is the
  // end.
  const Isosurface::Hit corner = surface.closest({8.5, 3, 0});
  EXPECT_NEAR(corner.distance, std::hypot(1.5, 1.125), 1e-6);
}

TEST(Isosurface, NothingWithinReach) {
  const Volume volume = exact_volume({16, 16, 16}, test::half_space({1, 0, 0}, 7.5));
  const Isosurface surface = isosurface_of(volume);
  for (const double d : {0.3, 1.0, 4.0}) {
    const Vec3 p{7.5 + d, 8.2, 7.9};
    EXPECT_TRUE(surface.closest(p, d + 1e-6).found());
    EXPECT_FALSE(surface.closest(p, d - 1e-6).found());
    EXPECT_TRUE(surface.closest_on_faces(p, d + 1e-6).found());
    EXPECT_FALSE(surface.closest_on_faces(p, d - 1e-6).found());
  }
}

// Vanishing gradients, plateaus at the isovalue, single samples: for any field the result is a
// point of the volume that is not farther than the faces plus their largest error.
TEST(Isosurface, WorksForAnyField) {
  for (int family = 0; family < test::kFamilies; ++family) {
    for (const std::uint64_t seed : {1, 2}) {
      const Volume volume =
          test::to_volume(test::random_samples(static_cast<test::Family>(family), {9, 8, 7}, seed),
                          SampleType::int32, {1, 1.5, 2});
      const InsideRule rule{0, Inside::above, NonFinite::refuse};
      const SurfaceComplex complex = parse_surface(volume, {rule, true});
      if (complex.faces.empty()) continue;
      const Isosurface surface(volume, rule, complex);
      Random random(seed);
      for (int k = 0; k < 500; ++k) {
        Vec3 p = random_in(random, {-2, -2, -2}, {10, 9, 8});
        if (k % 3 == 0) p = {std::round(p.x), std::round(p.y), std::round(p.z)};
        if (k % 5 == 0) p = complex.positions[random.bits() % complex.positions.size()];
        const Isosurface::Hit hit = surface.closest(p), face = surface.closest_on_faces(p);
        ASSERT_TRUE(hit.found());
        EXPECT_NEAR(length(to_metric(p - hit.point, complex.spacing)), hit.distance, 1e-9);
        EXPECT_LE(hit.distance, face.distance + 1)
            << test::name(static_cast<test::Family>(family)) << " " << k;
        EXPECT_GE(std::min({hit.point.x, hit.point.y, hit.point.z}), 0);
        EXPECT_LE(hit.point.x, 8);
        const double n = length(surface.normal(hit.point));
        EXPECT_TRUE(n == 0 || std::abs(n - 1) < 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace isoatlas::detail
