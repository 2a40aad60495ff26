// SPDX-License-Identifier: Apache-2.0
// Proved distances hold at many independent points, and proofs succeed well within the bound.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/vector_math.h"
#include "error/surface_proof.h"
#include "error/triangle_errors.h"
#include "geometry/closest_point.h"
#include "support/levels.h"

namespace isoatlas::detail {
namespace {

using namespace test;

// Smooth, anisotropic, cut by the volume boundary, with thin sheets, and noise.
std::vector<Volume> volumes() {
  std::vector<Volume> out;
  out.push_back(exact_volume({28, 28, 28}, bumpy_ball()));
  out.push_back(exact_volume({28, 28, 20}, bumpy_ball(), {1, 1, 2.5}));
  out.push_back(exact_volume({16, 15, 17}, gyroid(11.3, 0.1)));
  out.push_back(exact_volume({16, 16, 16}, [](double x, double y, double z) {
    return 0.35 - std::abs(z - 7.5 - 0.1 * x - 0.05 * y);
  }));
  Random random(5);
  std::vector<double> noise(9 * 8 * 10);
  for (double& f : noise) f = random.unit() - 0.5;
  Grid grid;
  grid.size = {9, 8, 10};
  out.push_back(own<double>(grid, SampleType::float64, std::move(noise)));
  return out;
}

Vec3 between(Vec3 low, Vec3 high, Random& random) {
  const auto pick = [&](double a, double b) { return a + random.unit() * (b - a); };
  return {pick(low.x, high.x), pick(low.y, high.y), pick(low.z, high.z)};
}

TEST(GradientRange, ContainsTheGradientsOfAllPointsOfTheBox) {
  Random random(3);
  for (const Volume& volume : volumes()) {
    for (const std::uint32_t factor : {1u, 3u}) {
      const InterpolatedField field(volume, {0, Inside::above, NonFinite::refuse},
                                    Interpolation::trilinear, factor);
      const Vec3 last = field.last();
      for (int k = 0; k < 300; ++k) {
        const Vec3 a = between({-1, -1, -1}, last + Vec3{1, 1, 1}, random);
        const Vec3 b = k % 3 == 0 ? Vec3{std::floor(a.x), std::floor(a.y), std::floor(a.z)}
                                  : a + between({-2, -2, -2}, {2, 2, 2}, random);
        const Vec3 low{std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)},
            high{std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
        const auto range = field.gradient_range(low, high, 64);
        ASSERT_TRUE(range);
        for (int i = 0; i < 30; ++i) {
          const Vec3 p = between(low, high, random);
          // The field is extended by a constant beyond the volume boundary; the gradient returned
          // by at() does not include this.
          const Vec3 q = between(low, high, random);
          const double change = field.at(q).value - field.at(p).value;
          double most = 1e-9, least = -1e-9;
          const auto add = [&](double g0, double g1, double way) {
            most += std::max(g0 * way, g1 * way);
            least += std::min(g0 * way, g1 * way);
          };
          add(range->low.x, range->high.x, q.x - p.x);
          add(range->low.y, range->high.y, q.y - p.y);
          add(range->low.z, range->high.z, q.z - p.z);
          ASSERT_LE(change, most);
          ASSERT_GE(change, least);
        }
      }
    }
  }
}

TEST(GradientRange, IsTheGradientAtAPoint) {
  const Volume volume = exact_volume({14, 15, 16}, sphere({6.4, 7.6, 7.55}, 5));
  const InterpolatedField field(volume, {0, Inside::above, NonFinite::refuse});
  const Vec3 p{3.3, 4.6, 5.2};
  const auto range = field.gradient_range(p, p, 1);
  ASSERT_TRUE(range);
  EXPECT_LT(length(range->high - range->low), 1e-12);
  EXPECT_LT(length(range->low - field.at(p).gradient), 1e-12);
  EXPECT_FALSE(field.gradient_range(p, p + Vec3{2, 2, 2}, 26));
  EXPECT_FALSE(
      InterpolatedField(volume, {0, Inside::above, NonFinite::refuse}, Interpolation::tricubic)
          .gradient_range(p, p, 1));
}

std::vector<CellId> all_cells(const LevelMesh& mesh) {
  std::vector<CellId> all(mesh.cell_count());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

Vec3 to_index(Vec3 p, Vec3 spacing) { return {p.x / spacing.x, p.y / spacing.y, p.z / spacing.z}; }

// Searches for closest points miss a nearer one in noise now and then; a change of sign finds it as
// well.
double distance(const TestLevel& level, Vec3 p, double enough) {
  const Vec3 spacing = level.isosurface().spacing();
  const double found = level.isosurface().closest(to_index(p, spacing)).distance;
  if (found <= enough || enough == 0) return found;
  const InterpolatedField& field = level.isosurface().field();
  const bool inside = field.at(to_index(p, spacing)).value >= 0;
  Random random(1);
  for (int k = 0; k < 20000; ++k) {
    const Vec3 q = p + between({-enough, -enough, -enough}, {enough, enough, enough}, random);
    if (length(q - p) <= enough && (field.at(to_index(q, spacing)).value >= 0) != inside)
      return enough;
  }
  return found;
}

double farthest_sample(const TestLevel& level, std::uint32_t triangle, double enough) {
  const std::array<Vec3, 3> t = level.mesh().corners(triangle);
  constexpr int kSteps = 24;
  double most = 0;
  for (int a = 0; a <= kSteps; ++a) {
    for (int b = 0; a + b <= kSteps; ++b) {
      const Vec3 p =
          (1.0 / kSteps) * (static_cast<double>(a) * t[0] + static_cast<double>(b) * t[1] +
                            static_cast<double>(kSteps - a - b) * t[2]);
      most = std::max(most, distance(level, p, enough));
    }
  }
  return most;
}

// No sample of a triangle is farther than its proof claims, and a triangle whose samples are well
// within the bound is proved.
TEST(TriangleProof, HoldsAtAllSamplesAndFailsOnlyNearTheBound) {
  std::size_t proved = 0, failed = 0;
  for (const Volume& volume : volumes()) {
    for (const float disk : {3.0f, 6.0f}) {
      const TestLevel level(volume, disk);
      const LevelMesh& mesh = level.mesh();
      for (const double bound : {0.1, 0.5, 1.5}) {
        double most = 0;
        std::vector<Farthest> from_mesh;
        measure_from_mesh(level.surface_data().measured_surface(), mesh, level.partition().cell_of,
                          all_cells(mesh), bound, Evidence::proof, from_mesh);
        for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
          const auto& cell = mesh.triangles[i];
          const bool is_proved =
              std::ranges::all_of(cell, [&](CellId c) { return from_mesh[c].at == kNone; });
          // The others are only measured to know whether all could have been proved.
          const double farthest =
              is_proved ? farthest_sample(level, i, bound) : farthest_sample(level, i, 0);
          if (is_proved) {
            ASSERT_LE(farthest, bound * (1 + 1e-6));
          }
          most = std::max(most, farthest);
          proved += is_proved;
          failed += !is_proved;
        }
        const bool all_proved =
            std::ranges::all_of(from_mesh, [](const Farthest& f) { return f.at == kNone; });
        if (most < 0.97 * bound) {
          EXPECT_TRUE(all_proved) << most << " of " << bound;
        }
      }
    }
  }
  EXPECT_GT(proved, 1000u);
  EXPECT_GT(failed, 1000u);
}

// The same for the isosurface, at points of it in all grid cells.
TEST(SurfaceProof, HoldsAtAllPointsAndFailsOnlyNearTheBound) {
  std::size_t proved = 0, failed = 0;
  Random random(8);
  for (const Volume& volume : volumes()) {
    for (const float disk : {3.0f, 6.0f}) {
      const TestLevel level(volume, disk);
      const LevelMesh& mesh = level.mesh();
      const SurfaceComplex& complex = level.surface_data().complex;
      const InterpolatedField& field = level.isosurface().field();
      const GridCellIndex grid_cell_index(complex, field.last());
      // Points on segments across the surface where the sign changes are on the isosurface,
      // independently of the product's search.
      double most = 0;
      for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
        for (int k = 0; k < 4; ++k) {
          const Vec3 cell{std::floor(complex.positions[v].x), std::floor(complex.positions[v].y),
                          std::floor(complex.positions[v].z)};
          Vec3 a = field.clamped(between(cell, cell + Vec3{1, 1, 1}, random)),
               b = field.clamped(between(cell, cell + Vec3{1, 1, 1}, random));
          if ((field.at(a).value >= 0) == (field.at(b).value >= 0)) continue;
          for (int halving = 0; halving < 50; ++halving) {
            const Vec3 middle = 0.5 * (a + b);
            ((field.at(middle).value >= 0) == (field.at(a).value >= 0) ? a : b) = middle;
          }
          const Vec3 p = to_metric(a, complex.spacing);
          double squared = INFINITY;
          for (const Triangle& t : mesh.triangles)
            squared = std::min(squared, closest_on_triangle(p, mesh.point[t[0]], mesh.point[t[1]],
                                                            mesh.point[t[2]])
                                            .squared_distance);
          most = std::max(most, std::sqrt(squared));
        }
      }
      for (const double bound : {0.1, 0.5, 1.5, 4.0}) {
        const auto left =
            prove_surface_near(level.surface_data().measured_surface(), grid_cell_index, mesh,
                               level.partition().cell_of, all_cells(mesh), bound);
        const bool all_proved =
            std::ranges::all_of(left, [](const Farthest& f) { return f.at == kNone; });
        if (most > bound * (1 + 1e-6)) {
          EXPECT_FALSE(all_proved) << most << " of " << bound;
        }
        for (const Farthest& f : left) {
          if (f.at != kNone) {
            EXPECT_GT(f.distance, bound * (1 - 1e-6));
          }
        }
        (all_proved ? proved : failed) += 1;
      }
    }
  }
  EXPECT_GE(proved, 8u);
  EXPECT_GE(failed, 8u);
}

// Every grid cell that the isosurface crosses has a c-vertex, so all of the isosurface is covered
// by the proof.
TEST(GridCellIndex, ListsAllThatTheIsosurfaceCrosses) {
  for (const Volume& volume : volumes()) {
    const TestLevel level(volume, 4);
    const InterpolatedField& field = level.isosurface().field();
    const GridCellIndex grid_cell_index(level.surface_data().complex, field.last());
    const Size n = volume.view.grid.size;
    std::size_t crossed = 0;
    for (std::size_t z = 0; z + 1 < n[2]; ++z) {
      for (std::size_t y = 0; y + 1 < n[1]; ++y) {
        for (std::size_t x = 0; x + 1 < n[0]; ++x) {
          const Vec3 low{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
          int inside = 0;
          for (int k = 0; k < 8; ++k)
            inside += field.at_sample(low + Vec3{static_cast<double>(k & 1),
                                                 static_cast<double>(k >> 1 & 1),
                                                 static_cast<double>(k >> 2)}) >= 0;
          if (inside == 0 || inside == 8) continue;
          const GridCellIndex::Key key = x + (n[0] - 1) * (y + (n[1] - 1) * z);
          EXPECT_EQ(grid_cell_index.low(key), low);
          EXPECT_FALSE(grid_cell_index.c_vertices(key).empty());
          ++crossed;
        }
      }
    }
    EXPECT_GT(crossed, 100u);
  }
}

}  // namespace
}  // namespace isoatlas::detail
