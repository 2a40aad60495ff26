// SPDX-License-Identifier: Apache-2.0
// Levels without self-intersections.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "isoatlas/extract.h"
#include "isoatlas/self_intersections.h"
#include "support/mesh_reference.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

std::size_t count_intersecting_pairs(const Extraction& e, std::size_t level) {
  return check_embedding(e.hierarchy.mesh(level)).pairs;
}

ExtractOptions options_with(bool allowed, Placement placement) {
  ExtractOptions options = coarse_options();
  options.allow_self_intersections = allowed;
  options.placement = placement;
  options.covering.max_radius = 40;
  options.refine = {{{Quantity::max_distance, 1.5}}, {{Quantity::max_distance, 0.4}}};
  return options;
}

TEST(Embedded, NoSelfIntersectionsInAnyLevel) {
  if (!is_thorough()) GTEST_SKIP() << kThoroughOnly;
  std::vector<Volume> volumes;
  for (const double level : {-0.9, 1.0})
    volumes.push_back(to_volume(sampled({26, 24, 25}, gyroid(11.3, level))));
  for (std::uint64_t seed = 0; seed < 3; ++seed)
    volumes.push_back(to_volume(random_samples(Family::white_noise, {9, 10, 8}, seed)));
  std::size_t before = 0;
  for (std::size_t v = 0; v < volumes.size(); ++v) {
    for (const Placement placement : {Placement::surface, Placement::balanced}) {
      const Extraction allowed = extract(volumes[v], options_with(true, placement)),
                       embedded = extract(volumes[v], options_with(false, placement));
      for (std::size_t l = 0; l < 3; ++l) {
        SCOPED_TRACE("volume " + std::to_string(v) + ", level " + std::to_string(l));
        before += count_intersecting_pairs(allowed, l);
        EXPECT_FALSE(allowed.report.levels[l].self_intersections.has_value()) << "not tested";
        EXPECT_EQ(count_intersecting_pairs(embedded, l), 0u);
        EXPECT_EQ(embedded.report.levels[l].self_intersections, 0u);
        EXPECT_EQ(count_manifold(embedded.hierarchy.mesh(l)).topology, embedded.report.reference);
        EXPECT_TRUE(embedded.report.levels[l].certificate.passed);
      }
    }
  }
  EXPECT_GT(before, 0u) << "else this shows nothing";
}

// Positions in the space and precision of files: a voxel has 2^17 doubles along an axis there, and
// 2^12 floats. Before these were tested, the first three had intersecting pairs.
TEST(Embedded, InTheCoordinatesOfFiles) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  for (const std::uint64_t seed : {14U, 21U, 28U, 35U}) {
    SCOPED_TRACE(seed);
    const bool is_far = seed % 2 == 0;
    Volume volume = to_volume(random_samples(Family::white_noise, {14, 14, 14}, seed));
    volume.view.grid.direction = {{{c, s, 0}, {-s * c, c * c, s}, {s * s, -s * c, c}}};
    volume.view.grid.origin = is_far ? Vec3{6e10, 6e10, 6e10} : Vec3{1500, -1800, 1700};
    ExtractOptions options = coarse_options();
    options.refine = {{{Quantity::max_distance, 0.5}}};
    const Extraction e = extract(volume, options);
    EXPECT_EQ(e.hierarchy.float32_origin.has_value(), true);
    for (std::size_t l = 0; l < 2; ++l) {
      TriangleMesh mesh = e.hierarchy.mesh(l);
      EXPECT_EQ(check_embedding(mesh).pairs, 0U) << l;
      EXPECT_EQ(e.report.levels[l].self_intersections, 0U) << l;
      for (const Vec3 origin :
           {is_far ? *e.hierarchy.float32_origin : Vec3{}, *e.hierarchy.float32_origin}) {
        std::vector<Vec3> rounded;
        for (const Vec3& p : mesh.positions) {
          const volatile float x = static_cast<float>(p.x - origin.x),
                               y = static_cast<float>(p.y - origin.y),
                               z = static_cast<float>(p.z - origin.z);
          rounded.push_back({x, y, z});
        }
        EXPECT_EQ(check_embedding({rounded, mesh.triangles}).pairs, 0U) << l;
      }
    }
  }
}

// Bounds that the grid is too coarse for: the surface is subdivided exactly as often as allowed,
// which reduces the distance.
TEST(AdaptiveSupersample, SubdividesAsOftenAsAllowed) {
  ExtractOptions options = coarse_options();
  options.allow_self_intersections =
      true;  // otherwise the surface is also subdivided where triangles intersect
  options.refine = {{{Quantity::max_distance, 0.02}}};
  std::vector<double> reached;
  for (const std::uint32_t times : {0u, 1u, 3u}) {
    options.adaptive_supersample = times;
    const Extraction e =
        extract(to_volume(random_samples(Family::white_noise, {6, 6, 6}, 3)), options);
    EXPECT_EQ(e.report.added_c_vertices > 0, times > 0);
    EXPECT_LE(e.report.max_subdivision_depth, static_cast<int>(times));
    reached.push_back(e.finest().constraints.front().reached);
  }
  EXPECT_LE(reached[1], reached[0]);
  EXPECT_LT(reached[2], 0.6 * reached[0]);
}

// Triangles that satisfy the requested aspect ratio are not changed.
TEST(MinAspect, BelowAThirdChangesFewerTriangles) {
  ExtractOptions options = coarse_options();
  options.allow_self_intersections = true;
  const Volume volume = to_volume(random_samples(Family::white_noise, {12, 12, 12}, 3));
  const auto shape_change_count = [&](double aspect) {
    options.refine = {{{Quantity::max_distance, 0.5}, {Quantity::min_aspect, aspect}}};
    const LevelReport level = extract(volume, options).finest();
    EXPECT_EQ(level.bad_triangles.empty(),
              level.quality.aspect_min >= aspect && level.quality.angles_above_150 == 0)
        << aspect;
    return level.flips + level.moves + level.displacements;
  };
  const std::size_t usual = shape_change_count(1.0 / 3);
  EXPECT_LT(shape_change_count(0.1), usual / 2);
  EXPECT_EQ(shape_change_count(1e-6), 0u);
  EXPECT_GT(shape_change_count(0.4), usual);
}

// Exactly the badly shaped triangles are listed.
TEST(Embedded, BadTrianglesAreListedWithTheirObstacles) {
  const Extraction e = extract(to_volume(random_samples(Family::white_noise, {12, 12, 12}, 3)),
                               options_with(false, Placement::surface));
  std::size_t listed = 0;
  for (const LevelReport& level : e.report.levels) {
    const auto shape_score = [](const BadTriangle& t) {
      return std::min(3 * t.aspect_ratio, (180 - t.largest_angle) / 30);
    };
    std::size_t needles = 0, caps = 0;
    for (std::size_t i = 0; i < level.bad_triangles.size(); ++i) {
      const BadTriangle& t = level.bad_triangles[i];
      EXPECT_LT(shape_score(t), 1);
      EXPECT_GE(shape_score(t), i == 0 ? 0 : shape_score(level.bad_triangles[i - 1]))
          << "worst first";
      needles += t.aspect_ratio < 1.0 / 3 ? 1 : 0;
      caps += t.largest_angle > 150 ? 1 : 0;
    }
    EXPECT_EQ(static_cast<double>(needles), std::round(level.quality.aspect_share_below_third *
                                                       static_cast<double>(level.triangles)));
    EXPECT_EQ(caps, level.quality.angles_above_150);
    listed += level.bad_triangles.size();
    EXPECT_LT(level.quality.aspect_share_below_third, 0.03);
  }
  EXPECT_GT(e.report.added_c_vertices, 0u);
  EXPECT_GT(listed, 0u) << "else this shows nothing";
}

// Orienting a component outward lowers radii, so cells may have to be added although no triangles
// intersect. Found by fuzzing.
TEST(Embedded, CellsAddedAfterAComponentWasInvertedAreMeshed) {
  Samples s = constant({3, 2, 6}, -128);
  s.values[1] = 1;
  s.values[2] = 0;
  s.values[3] = 63;
  ExtractOptions options = coarse_options();
  options.surface.isovalue = -127.5;
  options.allow_self_intersections = false;
  const Extraction e = extract(to_volume(s, SampleType::int8, {1e-6, 1, 1}), options);
  EXPECT_EQ(e.finest().certificate.cells_checked, e.mesh().positions.size());
  EXPECT_EQ(kinds_of(e.mesh()), e.report.reference.kinds);
}

}  // namespace
}  // namespace isoatlas::detail
