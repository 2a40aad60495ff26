// SPDX-License-Identifier: Apache-2.0
// extract() on shapes of known topology and size.
#include "isoatlas/extract.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "field/sample_type.h"
#include "support/mesh_counts.h"
#include "support/reference_topology.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

ExtractOptions at(double isovalue, Inside inside = Inside::above) {
  ExtractOptions out = coarse_options();
  out.surface.isovalue = isovalue;
  out.surface.inside = inside;
  return out;
}

// Recounts everything that the report contains about the mesh.
void expect_correct_report(const Extraction& e, const std::string& what) {
  const MeshCounts counts = count_mesh(e.mesh());
  ASSERT_EQ(counts.fault, "") << what;
  ASSERT_EQ(e.finest().topology, counts.topology) << what;
  ASSERT_EQ(e.report.reference, e.finest().topology) << what;
  ASSERT_TRUE(e.finest().certificate.passed) << what;
  ASSERT_EQ(e.report.coarsening.passed, !e.report.coarser_c_vertices.empty())
      << what << ": small surfaces are not coarsened";
  ASSERT_EQ(e.finest().certificate.cells_checked, e.mesh().positions.size()) << what;
  ASSERT_EQ(e.finest().certificate.triples_checked, e.mesh().triangles.size()) << what;
  ASSERT_EQ(e.finest().certificate.arcs_checked, counts.edges) << what;
  ASSERT_EQ(e.finest().quality.triangles, e.mesh().triangles.size()) << what;
  ASSERT_GT(e.report.total_seconds, 0) << what;
  for (const Vec3& p : e.mesh().positions)
    ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) << what;
}

bool same_bytes(const TriangleMesh& a, const TriangleMesh& b) {
  return a.positions.size() == b.positions.size() && a.triangles.size() == b.triangles.size() &&
         std::memcmp(a.positions.data(), b.positions.data(), a.positions.size() * sizeof(Vec3)) ==
             0 &&
         std::memcmp(a.triangles.data(), b.triangles.data(),
                     a.triangles.size() * sizeof(Triangle)) == 0;
}

TEST(Extract, KnownShapes) {
  for (const KnownVolume& known : known_volumes()) {
    const Volume volume = to_volume(known.samples);
    const Extraction e = extract(volume, at(known.isovalue));
    expect_correct_report(e, known.name);
    EXPECT_EQ(e.finest().topology.kinds, known.kinds)
        << known.name << ": " << text(e.finest().topology.kinds);
    ExtractOptions faces = at(known.isovalue);
    faces.surface.topology = Topology::faces;
    EXPECT_EQ(kinds_of(extract(volume, faces).mesh()), known.faces_kinds) << known.name;
    const Extraction below =
        extract(to_volume(negated(known.samples)), at(-known.isovalue, Inside::below));
    EXPECT_TRUE(same_bytes(e.mesh(), below.mesh()))
        << known.name << ": below is the negated volume";
    if (HasFatalFailure()) return;
  }
}

// Large disks use coarser complexes, small ones do not; the surface is the same in both cases.
TEST(Extract, KnownShapesWithAndWithoutCoarserComplexes) {
  bool coarsened = false, direct = false;
  for (const KnownVolume& known : known_volumes()) {
    for (const double radius : {1.0, 1000.0}) {
      ExtractOptions o = at(known.isovalue);
      o.covering.max_radius = radius;
      const Extraction e = extract(to_volume(known.samples), o);
      expect_correct_report(e, known.name);
      EXPECT_EQ(e.finest().topology.kinds, known.kinds)
          << known.name << ": " << text(e.finest().topology.kinds);
      (e.report.coarser_c_vertices.empty() ? direct : coarsened) = true;
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_TRUE(coarsened && direct);
}

// In the original volume's space, with its voxels, from more c-vertices.
TEST(Extract, Supersampled) {
  const Volume volume = to_volume(sampled({26, 27, 28}, torus({12.6, 13.3, 13.4}, 8, 3.4), 1000),
                                  SampleType::float32, {1, 1, 2});
  for (const Interpolation interpolation : {Interpolation::trilinear, Interpolation::tricubic}) {
    std::size_t c_vertices = 0;
    for (const std::uint32_t factor : {1u, 2u, 3u}) {
      ExtractOptions o = at(0);
      o.surface.interpolation = interpolation;
      o.supersample = factor;
      o.refine = {{{Quantity::max_distance, 0.5}}};
      o.measure_samples = 5000;
      RunControl one;
      one.threads = 1;
      const Extraction e = extract(volume, o), again = extract(volume, o, one);
      expect_correct_report(e, "factor " + std::to_string(factor));
      EXPECT_EQ(text(e.finest().topology.kinds), text({{1, 0, 1}}));
      EXPECT_TRUE(same_bytes(e.mesh(), again.mesh())) << "the number of threads";
      EXPECT_TRUE(e.finest().all_satisfied());
      EXPECT_LT(e.finest().measured->maximum(), 0.55);
      EXPECT_EQ(e.finest().measured->voxel, 1);
      if (factor == 1) c_vertices = e.report.c_vertices;
      EXPECT_NEAR(static_cast<double>(e.report.c_vertices) / static_cast<double>(c_vertices),
                  factor * factor, 0.5 * factor);
    }
  }
}

TEST(Extract, GyroidCutByTheBoundary) {
  for (const double period : {7.3, 11.0, 20.0}) {
    const Samples s = sampled({26, 24, 25}, gyroid(period, 0.15));
    const TopologySummary want = reference_topology(s, 0);
    EXPECT_GT(want.boundary_loops, 1);
    const Extraction e = extract(to_volume(s), at(0));
    expect_correct_report(e, "gyroid");
    EXPECT_EQ(e.finest().topology, want)
        << text(e.finest().topology.kinds) << " instead of " << text(want.kinds);
  }
}

TEST(Extract, WhiteNoise32) {
  const Samples s = random_samples(Family::white_noise, {32, 32, 32}, 1);
  const TopologySummary want = reference_topology(s, 0);
  EXPECT_GT(want.genus, 1000);
  ExtractOptions faces = at(0);
  faces.surface.topology = Topology::faces;
  const Extraction e = extract(to_volume(s), faces);
  expect_correct_report(e, "white noise");
  EXPECT_EQ(e.finest().topology, want);
  EXPECT_EQ(e.report.tunnels, 0u);
  EXPECT_GT(e.report.double_segments, 0u);
  const Extraction trilinear = extract(to_volume(s), at(0));
  expect_correct_report(trilinear, "white noise with tunnels");
  EXPECT_GT(trilinear.report.tunnels, 100u);
  EXPECT_EQ(trilinear.finest().topology.euler_characteristic,
            want.euler_characteristic - 2 * static_cast<std::int64_t>(trilinear.report.tunnels));
  EXPECT_EQ(trilinear.finest().topology.boundary_loops, want.boundary_loops);
}

// Two opposite corners of one cell; the saddle between them is at the isovalue exactly, so they are
// joined.
TEST(Extract, TheTrilinearTopologyIsTheDefault) {
  Samples s = constant({2, 2, 2}, -1);
  s.at(0, 0, 0) = s.at(1, 1, 1) = 3;
  EXPECT_EQ(kinds_of(extract(to_volume(s), at(0)).mesh()),
            (std::vector<TopologySummary::Kind>{{0, 2, 1}}));
  ExtractOptions faces = at(0);
  faces.surface.topology = Topology::faces;
  EXPECT_EQ(kinds_of(extract(to_volume(s), faces).mesh()),
            (std::vector<TopologySummary::Kind>{{0, 1, 2}}));
}

TEST(Extract, OneVoxelBlobIsATetrahedronAtLeast) {
  Samples s = constant({5, 5, 5}, -10);
  s.at(2, 2, 2) = 7;
  const Extraction e = extract(to_volume(s), at(0));
  EXPECT_GE(e.mesh().triangles.size(), 4u);
  EXPECT_GT(signed_volume(e.mesh()), 0);
  EXPECT_EQ(e.report.c_vertices, 8u);
  EXPECT_EQ(e.report.faces, 6u);
}

TEST(Extract, CoarseMeansCoarse) {
  const Extraction ball =
      extract(to_volume(sampled({64, 64, 64}, sphere({31.4, 31.6, 31.55}, 26))), at(0));
  EXPECT_LE(ball.mesh().triangles.size(), 60u) << "a smooth ball needs few triangles";
  const Extraction ring =
      extract(to_volume(sampled({64, 64, 24}, torus({31.4, 31.6, 11.55}, 20, 8))), at(0));
  EXPECT_LE(ring.mesh().triangles.size(), 250u);
  ExtractOptions finer = at(0);
  finer.covering.max_radius = 4;
  const Extraction fine =
      extract(to_volume(sampled({64, 64, 64}, sphere({31.4, 31.6, 31.55}, 26))), finer);
  EXPECT_GT(fine.mesh().triangles.size(), 4 * ball.mesh().triangles.size());
  EXPECT_NEAR(signed_volume(fine.mesh()), 4 * M_PI / 3 * 26 * 26 * 26,
              0.03 * 4 * M_PI / 3 * 26 * 26 * 26);
}

// -------------------------------------------------------------------------------------------------
// orientation

// The signed volume per component of a closed mesh.
std::vector<double> component_volumes(const TriangleMesh& mesh) {
  const MeshCounts counts = count_manifold(mesh);
  EXPECT_TRUE(counts.boundary.empty());
  std::vector<TriangleMesh> parts(counts.components.size());
  for (const Triangle& t : mesh.triangles)
    parts[counts.component_of_vertex[t[0]]].triangles.push_back(t);
  std::vector<double> out;
  for (TriangleMesh& part : parts) {
    part.positions = mesh.positions;
    out.push_back(signed_volume(part));
  }
  return out;
}

TEST(Orientation, BallCavityAndBelow) {
  const Samples solid = sampled({40, 40, 40}, sphere({19.3, 19.6, 19.45}, 16.2));
  const double volume = 4 * M_PI / 3 * std::pow(16.2, 3);
  const auto share_of_ball = [&](const Samples& s, Inside inside) {
    ExtractOptions o = at(0, inside);
    o.covering.max_radius = 2;
    return signed_volume(extract(to_volume(s), o).mesh()) /
           volume;  // the mesh is inscribed, so a little less than 1
  };
  for (const double share :
       {share_of_ball(solid, Inside::above), share_of_ball(negated(solid), Inside::below),
        -share_of_ball(solid, Inside::below), -share_of_ball(negated(solid), Inside::above)}) {
    EXPECT_GT(share, 0.9);
    EXPECT_LT(share, 1);
  }
}

// Every closed component of a solid encloses volume with the right sign at every level of
// coarseness.
TEST(Orientation, EveryComponentOfKnownShapesFacesOutwards) {
  for (const KnownVolume& known : known_volumes()) {
    const bool solids =
        known.name == "sphere" || known.name == "torus" || known.name == "torus about x" ||
        known.name == "double torus" || known.name == "linked tori" ||
        known.name.starts_with("one-voxel blob") || known.name == "domino and speck" ||
        known.name.starts_with("two samples across") || known.name.starts_with("one-voxel ring") ||
        known.name == "ball with three tunnels" || known.name == "plateau of ties inside";
    const bool hollows = known.name == "cavity" || known.name == "one-voxel hole" ||
                         known.name.starts_with("two holes across");
    if (!solids && !hollows) continue;
    const Extraction e = extract(to_volume(known.samples), at(known.isovalue));
    for (const LevelReport& level : e.report.levels)
      EXPECT_EQ(level.inverted_components, 0u) << known.name;
    for (const double volume : component_volumes(e.mesh()))
      EXPECT_GT((solids ? 1 : -1) * volume, 0) << known.name;
  }
}

TEST(Orientation, NestedShellsAlternate) {
  const Extraction e =
      extract(to_volume(sampled({32, 32, 32},
                                nested_shells({15.4, 15.6, 15.55}, {3.1, 5.4, 8.2, 10.1, 13.7}))),
              at(0));
  std::vector<double> volumes = component_volumes(e.mesh());
  ASSERT_EQ(volumes.size(), 5u);
  std::ranges::sort(volumes, {}, [](double v) { return std::abs(v); });
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(volumes[i] > 0, i % 2 == 0) << "shell " << i;
}

// The plane z = 4.3 with the inside below: every triangle looks up.
TEST(Orientation, HalfSpaceFacesAwayFromTheInside) {
  const Extraction e = extract(to_volume(sampled({9, 10, 11}, half_space({0, 0, 1}, 4.3))), at(0));
  double up = 0;
  for (const Triangle& t : e.mesh().triangles) {
    const Vec3 a = e.mesh().positions[t[0]], b = e.mesh().positions[t[1]],
               c = e.mesh().positions[t[2]];
    EXPECT_NEAR(a.z, 4.3, 1e-3);
    up += 0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
  }
  EXPECT_GT(up, 0);
}

TEST(Orientation, MirroredDirectionKeepsItOutwards) {
  const Samples solid = sampled({20, 20, 20}, sphere({9.4, 9.6, 9.55}, 7));
  for (const bool mirrored : {false, true}) {
    for (const Space space : {Space::lps, Space::ras, Space::voxel}) {
      Volume volume = to_volume(solid);
      if (mirrored) volume.view.grid.direction[1] = {0, -1, 0};
      ExtractOptions o = at(0);
      o.space = space;
      EXPECT_GT(signed_volume(extract(volume, o).mesh()), 0)
          << mirrored << " " << static_cast<int>(space);
    }
  }
}

// -------------------------------------------------------------------------------------------------
// spaces

TEST(Space, WorldOfAnAnisotropicTurnedGrid) {
  Volume volume = to_volume(sampled({24, 20, 22}, [](double x, double y, double z) {
    return 6 - std::hypot((x - 11.4) * 0.5, (y - 9.6) * 0.8,
                          (z - 10.55) * 0.6);  // a ball of radius 6 in world units
  }));
  volume.view.grid.spacing = {0.5, 0.8, 0.6};
  volume.view.grid.origin = {100, -50, 7};
  volume.view.grid.direction = {Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}};
  ExtractOptions o = at(0);
  o.covering.max_radius = 2;
  const Extraction lps = extract(volume, o);
  // Index (11.4, 9.6, 10.55) is the point origin + (-9.6 * 0.8, 11.4 * 0.5, 10.55 * 0.6).
  const Vec3 centre{100 - 7.68, -50 + 5.7, 7 + 6.33};
  for (const Vec3& p : lps.mesh().positions) {
    EXPECT_NEAR(std::hypot(p.x - centre.x, p.y - centre.y, p.z - centre.z), 6, 0.1);
  }
  const auto [low, high] = bounding_box(lps.mesh());
  EXPECT_NEAR(low.x, centre.x - 6, 0.4);
  EXPECT_NEAR(high.y, centre.y + 6, 0.4);
  EXPECT_NEAR(high.z - low.z, 12, 0.8);
  EXPECT_GT(signed_volume(lps.mesh()), 0.7 * 4 * M_PI / 3 * 216);  // coarse and inscribed
  EXPECT_LT(signed_volume(lps.mesh()), 4 * M_PI / 3 * 216);

  o.space = Space::ras;
  const Extraction ras = extract(volume, o);
  ASSERT_EQ(ras.mesh().positions.size(), lps.mesh().positions.size());
  for (std::size_t i = 0; i < lps.mesh().positions.size(); ++i) {
    const Vec3 p = lps.mesh().positions[i];
    EXPECT_EQ(ras.mesh().positions[i], (Vec3{-p.x, -p.y, p.z}));
  }
  EXPECT_EQ(ras.mesh().triangles, lps.mesh().triangles) << "two mirrorings are a rotation";

  o.space = Space::voxel;
  const Extraction voxel = extract(volume, o);
  ASSERT_EQ(voxel.mesh().positions.size(), lps.mesh().positions.size());
  for (std::size_t i = 0; i < lps.mesh().positions.size(); ++i) {
    const Vec3 w = volume.view.grid.to_world(voxel.mesh().positions[i]),
               p = lps.mesh().positions[i];
    EXPECT_NEAR(std::hypot(w.x - p.x, w.y - p.y, w.z - p.z), 0, 1e-12);
  }
  EXPECT_EQ(voxel.mesh().triangles, lps.mesh().triangles);
  // Shape is measured in the world, whatever the space.
  EXPECT_DOUBLE_EQ(voxel.finest().quality.edge_max, lps.finest().quality.edge_max);
  EXPECT_NEAR(ras.finest().quality.aspect_min, lps.finest().quality.aspect_min, 1e-12);
  EXPECT_NEAR(mesh_quality(lps.mesh()).edge_min, lps.finest().quality.edge_min, 1e-12);
}

TEST(Space, TransformReversesTrianglesWhereTheMapMirrors) {
  Grid grid;
  grid.size = {4, 4, 4};
  grid.spacing = {2, 2, 2};
  grid.direction[0] = {-1, 0, 0};
  TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  TriangleMesh same = mesh;
  transform_to(same, grid, Space::voxel);
  EXPECT_EQ(same.positions, mesh.positions);
  EXPECT_EQ(same.triangles, mesh.triangles);
  transform_to(mesh, grid, Space::lps);
  EXPECT_EQ(mesh.positions[1], (Vec3{-2, 0, 0}));
  EXPECT_EQ(mesh.triangles[0], (Triangle{0, 2, 1}));
}

// -------------------------------------------------------------------------------------------------
// determinism

TEST(Determinism, SameBytesTwiceAndForAnyNumberOfThreads) {
  for (const Family family : {Family::white_noise, Family::gyroid_cut, Family::few_values}) {
    const Volume volume = to_volume(random_samples(family, {18, 17, 19}, 8));
    RunControl one;
    one.threads = 1;
    const Extraction first = extract(volume, at(0), one);
    for (const int threads : {1, 2, 3, 8, 0}) {
      RunControl control;
      control.threads = threads;
      const Extraction again = extract(volume, at(0), control);
      EXPECT_TRUE(same_bytes(first.mesh(), again.mesh())) << name(family) << " " << threads;
      EXPECT_EQ(first.finest().certificate.repair_rounds, again.finest().certificate.repair_rounds);
      EXPECT_EQ(first.report.coarser_c_vertices, again.report.coarser_c_vertices);
    }
  }
}

TEST(Determinism, EverySampleTypeGivesTheSameMesh) {
  Samples s = sampled({20, 18, 19}, gyroid(9.4, 0.1), 40);
  const Extraction want = extract(to_volume(s), at(3));
  for (const SampleType type : kAllTypes) {
    const bool is_unsigned = name(type).starts_with("u");
    const Extraction got =
        extract(to_volume(is_unsigned ? plus(s, 120) : s, type), at(is_unsigned ? 123 : 3));
    EXPECT_TRUE(same_bytes(want.mesh(), got.mesh())) << name(type);
  }
}

// Negative zero, and samples that are equal to the isovalue, in floating point.
TEST(Determinism, NegativeZeroIsZero) {
  Grid grid;
  grid.size = {4, 4, 4};
  std::vector<float> plus_zero(64, -1.0f), minus_zero;
  plus_zero[1 + 4 * (1 + 4)] = plus_zero[2 + 4 * (1 + 4)] = 0.0f;
  for (const float v : plus_zero) minus_zero.push_back(v == 0 ? -0.0f : v);
  const Extraction a = extract(own(grid, SampleType::float32, plus_zero), at(0)),
                   b = extract(own(grid, SampleType::float32, minus_zero), at(-0.0));
  EXPECT_TRUE(same_bytes(a.mesh(), b.mesh()));
  EXPECT_EQ(kinds_of(a.mesh()), (std::vector<TopologySummary::Kind>{{0, 0, 1}}));
}

}  // namespace
}  // namespace isoatlas::detail
