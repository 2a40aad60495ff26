// SPDX-License-Identifier: Apache-2.0
// The six metrics against closed forms: a plane, a sphere, a cylinder. A circle of radius r on a
// sphere of radius R lies in a plane R - sqrt(R^2 - r^2) below the sphere's top; an arc of angle t
// is (t/2) / sin(t/2) times as long as its chord.
#include "error/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include "core/vector_math.h"
#include "support/levels.h"

namespace isoatlas::detail {
namespace {

using namespace test;

constexpr double kDegree = std::numbers::pi / 180;

// Has unit slope in world units if the function is a distance.
Function scaled_distance(Vec3 spacing, const Function& f) {
  return
      [=](double x, double y, double z) { return f(x * spacing.x, y * spacing.y, z * spacing.z); };
}

// A mesh of a plane has no error. Positions are float64, distances are float32 of lengths up to 40,
// so 1e-6 of them is rounding.
TEST(Metrics, APlaneIsPerfect) {
  struct Plane {
    Vec3 normal, spacing;
  };
  for (const auto& [normal, spacing] :
       {Plane{{0, 0, 1}, {1, 1, 1}}, Plane{{0.48, 0.36, 0.8}, {1, 1, 1}},
        Plane{{1, 0, 0}, {1, 2, 0.5}}, Plane{{0.48, 0.36, 0.8}, {1, 2, 1.5}},
        Plane{{-0.6, 0.64, 0.48}, {3, 1, 1}}}) {
    const Vec3 n = normal;
    const Vec3 middle = to_metric({11.5, 11.5, 11.5}, spacing);
    const double offset = dot(n, middle) + 0.13;
    const TestLevel level(exact_surface({24, 24, 24},
                                        scaled_distance(spacing,
                                                        [=](double x, double y, double z) {
                                                          return offset - dot(n, {x, y, z});
                                                        }),
                                        spacing),
                          2.5);
    int inner = 0;
    for (CellId c = 0; c < level.mesh().cell_count(); ++c) {
      const CellView cell = level.cell(c);
      bool inside = true;  // at the boundary the mesh cuts corners, so that c-vertices there are
                           // not above or below it
      for (const std::uint32_t t : level.mesh().triangles_of.row(c)) {
        for (const CellId other : level.mesh().triangles[t]) {
          inside = inside && !cell.graph.on_boundary[level.partition().site[other]];
        }
      }
      inner += inside;
      if (inside) {
        EXPECT_LE(max_distance(cell), 1e-5);
        EXPECT_LE(mean_distance(cell), 1e-5);
      }
      EXPECT_NEAR(area_curvature(cell), 1, 1e-9);
      EXPECT_NEAR(area_curvature_smooth(cell), 1, 1e-9);
      EXPECT_NEAR(geodesic_ratio(cell), 1, 1e-6);
      EXPECT_NEAR(normal_angle(cell), 0, 1e-5);
    }
    EXPECT_GE(inner, 1);
  }
}

class OnASphere : public ::testing::TestWithParam<double> {
 protected:
  static constexpr double kRadius = 20;
  static const TestLevel& level(double disk) {
    static std::map<double, std::unique_ptr<TestLevel>> made;
    auto& one = made[disk];
    if (!one)
      one = std::make_unique<TestLevel>(
          exact_volume({48, 48, 48}, sphere({23.4, 23.6, 23.55}, kRadius)), disk);
    return *one;
  }
  // The angle at the centre between the site and the farthest c-vertex on the boundary of the
  // Voronoi cell.
  static double extent(const TestLevel& level, CellId c) {
    const Vec3 centre{23.4, 23.6, 23.55};
    const Vec3 site =
        normalized(level.surface_data().surfels.point[level.partition().site[c]] - centre);
    double most = 0;
    for (const CVertexId v : level.mesh().c_vertices_of.row(c)) {
      const Vec3 p = normalized(level.surface_data().surfels.point[v] - centre);
      most = std::max(most, std::atan2(length(cross(site, p)), dot(site, p)));
    }
    return most;
  }
};

// The largest distance is that of the centre of the triangle with the largest circumscribed circle,
// if the centre is inside the triangle. C-vertices are about half a voxel from the centre and 0.02
// voxels off the sphere. The distance from the mesh is measured to the surfels' tangent planes,
// which are another 0.03 above the sphere half a voxel aside.
TEST_P(OnASphere, DistancesAreSagittas) {
  const TestLevel& level = OnASphere::level(GetParam());
  double largest = 0, from_mesh = 0, mean = 0, circle = 0;
  for (CellId c = 0; c < level.mesh().cell_count(); ++c) {
    const CellView cell = level.cell(c);
    EXPECT_LE(mean_distance(cell), max_distance(cell) + 1e-6);
    EXPECT_GT(mean_distance(cell), 0);
    for (const ClosestPoint& p : cell.closest) largest = std::max<double>(largest, p.distance);
    from_mesh = std::max<double>(from_mesh, cell.from_mesh);
    mean = std::max(mean, mean_distance(cell));
  }
  for (std::uint32_t t = 0; t < level.mesh().triangles.size(); ++t) {
    const auto [p, q, r] = level.mesh().corners(t);
    const double a = length(q - p), b = length(r - q), c = length(p - r);
    const double area = 0.5 * length(cross(q - p, r - p));
    const double longest = std::max({a, b, c});
    const bool acute = 2 * longest * longest < a * a + b * b + c * c;
    circle = std::max(circle, acute ? a * b * c / (4 * area) : longest / 2);
  }
  const double sagitta = kRadius * (1 - std::sqrt(1 - circle * circle / (kRadius * kRadius)));
  EXPECT_NEAR(largest, sagitta, 0.05 * sagitta + 0.04);
  EXPECT_GT(from_mesh, 0.85 * sagitta - 0.04);
  EXPECT_LT(from_mesh, 1.05 * sagitta + 0.07);
  EXPECT_LT(mean, 0.85 * largest);
}

// For a cap of angular radius t over a flat triangle, surface over projection is about 2 / (1 + cos
// t). With normals interpolated between corners the two nearly agree everywhere, so the smooth
// ratio is nearer to 1.
TEST_P(OnASphere, AreaRatiosGoWithTheAngle) {
  const TestLevel& level = OnASphere::level(GetParam());
  double flat = 0, smooth = 0, widest = 0;
  for (CellId c = 0; c < level.mesh().cell_count(); ++c) {
    const CellView cell = level.cell(c);
    double area = 0, seen = 0;  // for comparison, computed from the sphere itself
    for (std::size_t i = 0; i < cell.c_vertices.size(); ++i) {
      const CVertexId v = cell.c_vertices[i];
      const Vec3 radial = normalized(cell.surfels.point[v] - Vec3{23.4, 23.6, 23.55});
      EXPECT_GT(dot(radial, cell.surfels.normal[v]), 0.995) << "surfels face outwards";
      area += cell.surfels.area[v];
      seen += cell.surfels.area[v] * dot(radial, cell.triangle_normal[cell.closest[i].triangle]);
    }
    EXPECT_NEAR(area_curvature(cell), area / seen, 0.003);
    EXPECT_GE(area_curvature(cell), 1);
    EXPECT_GE(area_curvature_smooth(cell), 1);
    flat = std::max(flat, area_curvature(cell));
    smooth = std::max(smooth, area_curvature_smooth(cell));
    widest = std::max(widest, extent(level, c));
  }
  EXPECT_LT(smooth, flat);
  EXPECT_LT(smooth - 1, 0.5 * (flat - 1) + 0.002);
  EXPECT_LT(flat, 1 / std::cos(2 * widest));
}

// Surfel normals of a digital sphere are a degree or two off, and the sum of unsigned angles along
// a zigzag path is longer than the turn: never shorter by more than the error of the normals, and
// longer by the path's 8 % and some noise.
TEST_P(OnASphere, AnglesAndRatiosAreThoseOfArcs) {
  const TestLevel& level = OnASphere::level(GetParam());
  for (CellId c = 0; c < level.mesh().cell_count(); ++c) {
    const double t = extent(level, c);
    EXPECT_NEAR(geodesic_ratio(level.cell(c)), (t / 2) / std::sin(t / 2), 0.012)
        << t / kDegree << " degrees";
    EXPECT_GE(normal_angle(level.cell(c)), 0.9 * t / kDegree - 1);
    EXPECT_LE(normal_angle(level.cell(c)), 1.15 * t / kDegree + 2);
  }
}

INSTANTIATE_TEST_SUITE_P(Disks, OnASphere, ::testing::Values(4.0, 8.0, 16.0));

// Around the axis normals turn by the arc over the radius, along it not at all.
TEST(Metrics, ACylinderTurnsOnlyAroundItsAxis) {
  constexpr double kRadius = 12;
  const Vec3 centre{15.4, 15.6, 0};
  const TestLevel level(exact_surface({32, 32, 40},
                                      [=](double x, double y, double) {
                                        return kRadius - std::hypot(x - centre.x, y - centre.y);
                                      }),
                        7);
  for (CellId c = 0; c < level.mesh().cell_count(); ++c) {
    const CellView cell = level.cell(c);
    const Vec3 site = cell.surfels.point[cell.site];
    double turn = 0;
    for (const CVertexId v : cell.c_vertices) {
      const Vec3 p = cell.surfels.point[v];
      const Vec3 a{site.x - centre.x, site.y - centre.y, 0}, b{p.x - centre.x, p.y - centre.y, 0};
      turn = std::max(turn, std::atan2(length(cross(a, b)), dot(a, b)) / kDegree);
    }
    EXPECT_GE(normal_angle(cell), 0.9 * turn - 1);
    EXPECT_LE(normal_angle(cell), 1.15 * turn + 2);
  }
}

// On hand-made complexes, where weights are whole numbers.
TEST(Metrics, FlatGridHasNoAngleAndNoDetour) {
  const TestLevel level(flat_grid(23, 19), 6);
  for (CellId c = 0; c < level.mesh().cell_count(); ++c) {
    EXPECT_EQ(normal_angle(level.cell(c)), 0);
    EXPECT_NEAR(area_curvature(level.cell(c)), 1, 1e-12);
    EXPECT_NEAR(geodesic_ratio(level.cell(c)), 1, 1e-6);
  }
}

TEST(Metrics, InvertedMeshHasInfiniteAreaCurvature) {
  const SurfaceComplex grid = flat_grid(5, 5);
  const SurfaceData surface_data(grid);
  std::vector<float> geodesic(25, 1);
  std::vector<CellId> cell_of(25, 0);
  const std::vector<Vec3> vertex_normal{{0, 0, 1}};
  const std::vector<Triangle> triangles{{0, 0, 0}};
  const std::vector<Vec3> triangle_normal{{0, 0, -1}};
  const std::vector<CVertexId> own{12};
  const std::vector<ClosestPoint> closest{{0, {1, 0, 0}, 0.5f}};
  const CellView cell{surface_data.surfels,
                      surface_data.graph,
                      geodesic,
                      cell_of,
                      vertex_normal,
                      triangles,
                      triangle_normal,
                      12,
                      own,
                      closest,
                      0.75f};
  EXPECT_TRUE(std::isinf(area_curvature(cell)));
  EXPECT_NEAR(area_curvature_smooth(cell), 1, 1e-12) << "the vertices' normals are right";
  EXPECT_EQ(max_distance(cell), 0.75) << "the way from the mesh counts";
  EXPECT_EQ(mean_distance(cell), 0.5);
  EXPECT_EQ(geodesic_ratio(cell), 1);
  EXPECT_EQ(normal_angle(cell), 0);
}

TEST(Surfels, AreasSumToTheTotal) {
  for (const Vec3 spacing : {Vec3{1, 1, 1}, Vec3{1, 2, 0.5}}) {
    SurfaceComplex grid = flat_grid(7, 5);
    grid.spacing = spacing;
    const Surfels surfels = make_surfels(grid);
    double sum = 0;
    for (const float a : surfels.area) sum += a;
    EXPECT_NEAR(sum, 6 * 4 * spacing.x * spacing.y, 1e-5);
    for (const Vec3 n : surfels.normal) EXPECT_NEAR(n.z, 1, 1e-12);
    EXPECT_EQ(surfels.point[8], to_metric(grid.positions[8], spacing));
  }
}

TEST(Quantities, NamesAreUnique) {
  for (std::size_t q = 0; q < kQuantityCount; ++q) {
    const auto quantity = static_cast<Quantity>(q);
    EXPECT_EQ(quantity_named(name(quantity)), quantity);
  }
  EXPECT_EQ(quantity_named("max-distances"), std::nullopt);
  EXPECT_EQ(quantity_named(""), std::nullopt);
  EXPECT_EQ(unit(Quantity::normal_angle), Unit::degrees);
  EXPECT_EQ(unit(Quantity::min_aspect), Unit::ratio);
  EXPECT_EQ(unit(Quantity::max_edge), Unit::length);
  EXPECT_TRUE(is_lower_bound(Quantity::min_aspect));
  EXPECT_FALSE(is_lower_bound(Quantity::max_vertices));
  EXPECT_FALSE(is_metric(Quantity::max_vertices));
}

}  // namespace
}  // namespace isoatlas::detail
