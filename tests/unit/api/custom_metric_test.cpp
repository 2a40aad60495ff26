// SPDX-License-Identifier: Apache-2.0
// Metrics and edge-length fields of the caller's own.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <numbers>
#include <stdexcept>

#include "core/vector_math.h"
#include "isoatlas/isoatlas.h"
#include "support/surfaces.h"
#include "support/volumes.h"

namespace isoatlas::test {
namespace {

using namespace isoatlas::detail;

// A ball of radius 2 around (10, 20, 30), on a grid that is rotated, mirrored and anisotropic.
constexpr Vec3 kCentre{10, 20, 30};

Volume ball() {
  const double c = std::cos(0.4), s = std::sin(0.4);
  Grid grid;
  grid.size = {52, 52, 36};
  grid.spacing = {0.1, 0.1, 0.15};
  grid.direction = {Vec3{c, s, 0}, Vec3{s, -c, 0}, Vec3{0, 0, 1}};
  const Vec3 middle = grid.to_world({25.6, 25.3, 17.4});
  grid.origin = kCentre - middle;
  return sample([](Vec3 p) { return 2 - length(p - kCentre); }, grid);
}

double longest_edge_over(const TriangleMesh& mesh, const std::function<double(Vec3)>& allowed) {
  double most = 0;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = mesh.positions[t[k]], b = mesh.positions[t[(k + 1) % 3]];
      most = std::max(most, length(a - b) / allowed(0.5 * (a + b)));
    }
  return most;
}

TEST(CustomMetric, SeesTheCellInTheWorld) {
  double area = 0;  // of the last evaluation of every cell
  std::map<std::array<long, 3>, double> area_at;
  const auto key = [](Vec3 p) {
    return std::array<long, 3>{std::lround(p.x * 1e6), std::lround(p.y * 1e6),
                               std::lround(p.z * 1e6)};
  };
  std::mutex mutex;
  const auto metric = [&](const CellGeometry& cell) {
    EXPECT_NEAR(length(cell.vertex - kCentre), 2, 0.05);
    EXPECT_GT(dot(cell.normal, normalized(cell.vertex - kCentre)), 0.98);
    EXPECT_EQ(cell.points.size(), cell.normals.size());
    EXPECT_EQ(cell.points.size(), cell.areas.size());
    EXPECT_GE(cell.triangles.size(), 3u);
    double sum = 0;
    for (std::size_t i = 0; i < cell.points.size(); ++i) {
      EXPECT_NEAR(length(cell.points[i] - kCentre), 2, 0.02);
      EXPECT_NEAR(length(cell.normals[i]), 1, 1e-6);
      sum += cell.areas[i];
    }
    for (const auto& t : cell.triangles) {
      EXPECT_EQ(t[0], cell.vertex);
      EXPECT_GT(dot(cross(t[1] - t[0], t[2] - t[0]), t[0] - kCentre),
                0);  // counter-clockwise seen from outside
    }
    const std::lock_guard lock(mutex);
    area_at[key(cell.vertex)] = sum;
    return 0.5;
  };
  const Extraction e = extract(ball(), 0, {{bounded("nothing", metric, 1)}});
  for (const Vec3& p : e.mesh().positions) area += area_at.at(key(p));
  EXPECT_NEAR(area, 4 * std::numbers::pi * 4, 0.5);
  const ConstraintResult& result = e.finest().constraints.at(0);
  EXPECT_EQ(name(result.constraint), "nothing");
  EXPECT_EQ(result.reached, 0.5);
  EXPECT_TRUE(result.satisfied);
}

TEST(CustomMetric, BoundsTheSizeOfCells) {
  const auto area = [](const CellGeometry& cell) {
    double sum = 0;
    for (const double a : cell.areas) sum += a;
    return sum;
  };
  const Volume volume = ball();
  std::size_t before = 0;
  for (const double bound : {4.0, 1.0, 0.25}) {
    const Extraction e = extract(volume, 0, {{bounded("area", area, bound)}});
    EXPECT_TRUE(e.finest().constraints.at(0).satisfied) << bound;
    EXPECT_LE(e.finest().constraints.at(0).reached, bound);
    EXPECT_GT(e.finest().vertices, before);
    EXPECT_GE(static_cast<double>(e.finest().vertices), 4 * std::numbers::pi * 4 / bound - 1);
    before = e.finest().vertices;
  }
}

TEST(CustomMetric, EdgeLengthFieldBoundsEdgesWhereTheyAre) {
  const Volume volume = ball();
  const auto allowed = [](Vec3 p) {
    return 0.35 + 0.35 * (p.z - (kCentre.z - 2));
  };  // fine below, coarse above
  const Extraction sized = extract(volume, 0, {{sized_by(allowed)}}),
                   even = extract(volume, 0, {{bounded(Quantity::max_edge, 0.35)}});
  const ConstraintResult& result = sized.finest().constraints.at(0);
  EXPECT_TRUE(result.satisfied) << result.reached;
  EXPECT_LE(longest_edge_over(sized.mesh(), allowed), 1);
  EXPECT_NEAR(longest_edge_over(sized.mesh(), allowed), result.reached, 1e-6);
  EXPECT_LT(2 * sized.finest().vertices, even.finest().vertices);
  EXPECT_EQ(detail::test::kinds_of(sized.mesh()), (std::vector<TopologySummary::Kind>{{0, 0, 1}}));
  EXPECT_EQ(detail::test::kinds_of(even.mesh()), (std::vector<TopologySummary::Kind>{{0, 0, 1}}));
  EXPECT_EQ(sized.finest().self_intersections, 0u);
}

TEST(CustomMetric, GoesWithOtherConstraintsAndSeveralLevels) {
  const auto edges = sized_by([](Vec3) { return 1.0; });
  const Extraction e =
      extract(ball(), 0, {{edges}, {within(0.02), edges, sized_by([](Vec3) { return 0.6; })}});
  ASSERT_EQ(e.report.levels.size(), 3u);
  EXPECT_TRUE(e.report.levels[1].all_satisfied());
  EXPECT_TRUE(e.finest().all_satisfied());
  // A level that is not refined, since it has its vertices, is evaluated all the same.
  ExtractOptions few;
  few.refine = {{{Quantity::max_vertices, 1}, edges}};
  const ConstraintResult result = extract(ball(), few).finest().constraints.at(1);
  EXPECT_FALSE(result.satisfied);
  EXPECT_GT(result.reached, 1);
  EXPECT_TRUE(std::isfinite(result.reached));
}

// Was std::bad_function_call in extract().
TEST(CustomMetric, EdgeLengthFieldWithoutFunctionIsABadArgument) {
  EXPECT_THROW(sized_by(nullptr), Error);
}

TEST(CustomMetric, ErrorsComeThrough) {
  const auto code_of = [](const LevelGoal& goal) {
    try {
      extract(ball(), 0, {goal});
    } catch (const Error& error) {
      return error.code();
    }
    throw std::runtime_error("nothing was thrown");
  };
  EXPECT_EQ(code_of(bounded(
                "nan", [](const CellGeometry&) { return std::nan(""); }, 1)),
            ErrorCode::bad_argument);
  EXPECT_EQ(code_of(sized_by([](Vec3) { return 0.0; })), ErrorCode::bad_argument);
  EXPECT_EQ(code_of(bounded("none", {}, 1)), ErrorCode::bad_argument);
  EXPECT_EQ(code_of(Constraint{Quantity::custom, 1}), ErrorCode::bad_argument);
  EXPECT_THROW(
      extract(
          ball(), 0,
          {{bounded(
              "mine", [](const CellGeometry&) -> double { throw std::logic_error("mine"); }, 1)}}),
      std::logic_error);
}

}  // namespace
}  // namespace isoatlas::test
