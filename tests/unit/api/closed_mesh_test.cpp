// SPDX-License-Identifier: Apache-2.0
// Meshes that are closed on the volume boundary.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "core/vector_math.h"
#include "isoatlas/extract.h"
#include "support/mesh_counts.h"
#include "support/mesh_reference.h"
#include "support/reference_topology.h"
#include "support/surfaces.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using namespace test;

constexpr std::int64_t kOutside = -1000000;

// The volume with a layer of samples around it that are outside.
Samples padded(const Samples& s) {
  Samples out = constant({s.size[0] + 2, s.size[1] + 2, s.size[2] + 2}, kOutside);
  for (std::size_t z = 0; z < s.size[2]; ++z) {
    for (std::size_t y = 0; y < s.size[1]; ++y) {
      for (std::size_t x = 0; x < s.size[0]; ++x) out.at(x + 1, y + 1, z + 1) = s.at(x, y, z);
    }
  }
  return out;
}

ExtractOptions closed_options(double isovalue) {
  ExtractOptions out;
  out.surface.isovalue = isovalue;
  out.surface.topology = Topology::faces;  // that of the reference
  out.border = Border::closed;
  return out;
}

// The faces of the box that contain a point; the space of the mesh is Space::voxel.
std::set<int> faces_of(Vec3 p, const Size& size) {
  std::set<int> out;
  const double at[3]{p.x, p.y, p.z};
  for (int a = 0; a < 3; ++a) {
    if (at[a] == 0) out.insert(2 * a);
    if (at[a] == static_cast<double>(size[static_cast<std::size_t>(a)] - 1)) out.insert(2 * a + 1);
  }
  return out;
}

bool is_on_one_face(const TriangleMesh& mesh, const Triangle& t, const Size& size) {
  for (const int face : faces_of(mesh.positions[t[0]], size)) {
    if (faces_of(mesh.positions[t[1]], size).count(face) != 0 &&
        faces_of(mesh.positions[t[2]], size).count(face) != 0)
      return true;
  }
  return false;
}

double volume_of(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    sum += dot(mesh.positions[t[0]], cross(mesh.positions[t[1]], mesh.positions[t[2]]));
  return sum / 6;
}

// Empty, or what is wrong with a closed mesh in Space::voxel.
std::string what_is_wrong(const Extraction& e, const Samples& samples, double isovalue) {
  const TopologySummary expected = reference_topology(padded(samples), isovalue);
  if (e.report.reference != expected)
    return "reference " + text(e.report.reference.kinds) + " instead of " + text(expected.kinds);
  for (std::size_t k = 0; k < e.hierarchy.levels.size(); ++k) {
    const std::string where = "level " + std::to_string(k) + ": ";
    const TriangleMesh mesh = e.hierarchy.mesh(k);
    const LevelReport& report = e.report.levels[k];
    const MeshCounts counts = count_mesh(mesh);
    if (!counts.fault.empty()) return where + counts.fault;
    if (!counts.boundary.empty()) return where + "open";
    if (counts.topology != expected) return where + text(counts.topology.kinds);
    if (report.topology != expected) return where + "the report has another topology";
    const EmbeddingCheck embedding = check_embedding(mesh);
    if (embedding.pairs != 0 || embedding.without_area != 0)
      return where + std::to_string(embedding.pairs) + " intersections, " +
             std::to_string(embedding.without_area) + " triangles without area";
    if (report.self_intersections != 0) return where + "the report has self-intersections";
    if (misplaced_components(mesh) != 0) return where + "a component is misplaced";
    const std::size_t caps = e.hierarchy.levels[k].cap_triangles;
    if (!report.caps || report.caps->triangles != caps) return where + "the report has other caps";
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const bool is_cap = t + caps >= mesh.triangles.size();
      if (is_on_one_face(mesh, mesh.triangles[t], samples.size) != is_cap)
        return where + "triangle " + std::to_string(t) + (is_cap ? " is no cap" : " is a cap");
    }
    if (k > 0 && e.hierarchy.levels[k - 1].vertex_count > e.hierarchy.levels[k].vertex_count)
      return where + "fewer vertices";
  }
  return "";
}

TEST(ClosedMesh, RandomVolumes) {
  const int rounds = is_thorough() ? 25 : 6;
  int with_caps = 0;
  for (int family = 0; family < kFamilies; ++family) {
    for (int seed = 0; seed < rounds; ++seed) {
      Random random(static_cast<std::uint64_t>(1000 * family + seed));
      const auto side = [&] { return static_cast<std::size_t>(random.between(2, 9)); };
      const Size size{side(), side(), side()};
      const Samples samples = random_samples(static_cast<Family>(family), size, random.bits());
      if (!has_surface(samples, 0)) continue;
      ExtractOptions options = closed_options(0);
      options.space = Space::voxel;
      const Extraction e = extract(to_volume(samples), options);
      ASSERT_EQ(what_is_wrong(e, samples, 0), "")
          << name(static_cast<Family>(family)) << " " << seed << ", " << size[0] << " x " << size[1]
          << " x " << size[2];
      with_caps += e.finest().caps->triangles > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(with_caps, rounds * kFamilies / 2);
}

TEST(ClosedMesh, CutShapesAtCoarseAndFineLevels) {
  struct Shape {
    const char* name;
    Samples samples;
  };
  const std::vector<Shape> shapes{
      {"half a ball", sampled({20, 20, 20}, sphere({9.5, 9.5, 0.3}, 8.2))},
      {"a ball at a corner", sampled({20, 20, 20}, sphere({0.2, 0.3, 0.1}, 12.7))},
      {"a ball beyond an edge", sampled({20, 20, 20}, sphere({-2.2, -3.3, 9.4}, 12.7))},
      {"a torus cut twice", sampled({30, 30, 16}, torus({14.5, 0.2, 7.6}, 9, 3.4))},
      {"a slab", sampled({16, 17, 18}, half_space({0.3, 0.2, 1}, 9.3))},
      {"a cavity", negated(sampled({16, 16, 16}, sphere({7.4, 7.6, 7.5}, 5)))},
      {"a gyroid", sampled({24, 24, 24}, gyroid(12, 0.1))}};
  for (const Shape& shape : shapes) {
    ExtractOptions options = closed_options(0.5);
    options.space = Space::voxel;
    options.refine = {within(2 * vx), within(0.5 * vx)};
    const Extraction e = extract(to_volume(shape.samples), options);
    EXPECT_EQ(what_is_wrong(e, shape.samples, 0.5), "") << shape.name;
    EXPECT_GT(volume_of(e.mesh()), 0) << shape.name;
    EXPECT_TRUE(e.finest().all_satisfied()) << shape.name;
  }
}

// The cap of half a ball is a disk in its plane.
TEST(ClosedMesh, EnclosesTheVolumeInside) {
  const Samples half = sampled({41, 41, 22}, sphere({20, 20, 0}, 17), 100000);
  ExtractOptions options = closed_options(0.5);
  options.refine = {within(0.1 * vx)};
  const Extraction e = extract(to_volume(half), options);
  constexpr double kPi = 3.14159265358979323846;
  EXPECT_NEAR(volume_of(e.mesh()), 2.0 / 3 * kPi * std::pow(17, 3), 0.1 * 2 * kPi * 17 * 17);
  EXPECT_NEAR(e.finest().caps->area, kPi * 17 * 17, 6);
}

// The vertices of a level are the first ones of the next, corners of the box included.
TEST(ClosedMesh, LevelsAreNested) {
  const Samples samples = sampled({20, 20, 20}, sphere({-2.2, -3.3, 9.4}, 19.7));
  for (const Placement placement : {Placement::surface, Placement::balanced}) {
    ExtractOptions options = closed_options(0.5);
    options.placement = placement;
    options.refine = {within(2 * vx), within(0.5 * vx), within(0.2 * vx)};
    const Extraction e = extract(to_volume(samples), options);
    ASSERT_EQ(e.hierarchy.levels.size(), 4u);
    const auto& parent = e.hierarchy.parent;
    ASSERT_EQ(parent.size(), e.hierarchy.positions.size());
    for (std::size_t k = 0; k < 4; ++k) {
      const Hierarchy::Level& level = e.hierarchy.levels[k];
      EXPECT_EQ(level.distance.size(), level.vertex_count);
      EXPECT_GT(level.cap_triangles, 0u);
      const MeshCounts counts = count_mesh(e.hierarchy.mesh(k));
      EXPECT_EQ(counts.fault, "");
      if (k == 0) continue;
      const std::uint32_t before = e.hierarchy.levels[k - 1].vertex_count;
      for (std::uint32_t v = before; v < level.vertex_count; ++v) EXPECT_LT(parent[v], before);
      for (std::uint32_t v = 0; v < level.vertex_count; ++v)
        EXPECT_LE(length(e.hierarchy.mesh(k).positions[v] - e.hierarchy.positions[v]),
                  placement == Placement::surface ? 0 : 0.8);
    }
  }
}

// Rotated, far away and anisotropic grids; supersampled; as inside below.
TEST(ClosedMesh, IsClosedForAnyGrid) {
  const Samples samples = random_samples(Family::gyroid_cut, {14, 15, 13}, 77);
  for (int variant = 0; variant < 5; ++variant) {
    Volume volume = to_volume(samples, SampleType::int32, {1, 1.5, variant == 1 ? 4.0 : 0.7});
    ExtractOptions options = closed_options(0);
    if (variant == 2) {
      volume.view.grid.origin = {12345.6, -98765.4, 3210.1};
      const double c = std::cos(0.7), s = std::sin(0.7);
      volume.view.grid.direction = {Vec3{c, s, 0}, Vec3{-s * c, c * c, s}, Vec3{s * s, -c * s, c}};
    }
    if (variant == 3) options.supersample = 2;
    if (variant == 4) options.surface.topology = Topology::trilinear;
    const Extraction e = extract(volume, options);
    for (std::size_t k = 0; k < e.hierarchy.levels.size(); ++k) {
      const TriangleMesh mesh = e.hierarchy.mesh(k);
      const MeshCounts counts = count_mesh(mesh);
      EXPECT_EQ(counts.fault, "") << variant;
      EXPECT_TRUE(counts.boundary.empty()) << variant;
      EXPECT_EQ(counts.topology, e.report.reference) << variant;
      EXPECT_EQ(check_embedding(mesh).pairs, 0u) << variant;
      if (variant < 3) {
        EXPECT_EQ(counts.topology, reference_topology(padded(samples), 0));
      }
      EXPECT_GT(volume_of(mesh), 0) << variant;
    }
    RunControl one_thread;
    one_thread.threads = 1;
    const Extraction again = extract(volume, options, one_thread);
    EXPECT_EQ(again.hierarchy.positions, e.hierarchy.positions) << variant;
    EXPECT_EQ(again.mesh().triangles, e.mesh().triangles) << variant;
  }
  const Volume below = to_volume(negated(samples));
  ExtractOptions options = closed_options(0);
  const Extraction above = extract(to_volume(samples), options);
  options.surface.inside = Inside::below;
  EXPECT_EQ(extract(below, options).mesh().triangles, above.mesh().triangles);
}

TEST(ClosedMesh, ChosenComponentsAreCapped) {
  const Samples samples =
      sampled({30, 20, 20}, unite(sphere({8, 9.5, 0.3}, 7.2), sphere({23, 9.4, 0.2}, 4.3)));
  ExtractOptions options = closed_options(0.5);
  options.components.keep_largest = 1;
  const Extraction e = extract(to_volume(samples), options);
  EXPECT_EQ(text(kinds_of(e.mesh())), text({{0, 0, 1}}));
  EXPECT_NEAR(e.finest().caps->area, 3.14159 * 7.2 * 7.2, 10);

  // Inside is everywhere on the boundary: the surface of the box is one more component.
  const Samples cavity = negated(sampled({16, 16, 16}, sphere({7.4, 7.6, 7.5}, 5)));
  try {
    extract(to_volume(cavity), options);
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unsupported);
  }
}

TEST(ClosedMesh, NeedsAMeshWithoutSelfIntersections) {
  ExtractOptions options = closed_options(0.5);
  options.allow_self_intersections = true;
  try {
    extract(to_volume(sampled({9, 9, 9}, sphere({4, 4, 0}, 3))), options);
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_argument);
  }
}

}  // namespace
}  // namespace isoatlas::detail
