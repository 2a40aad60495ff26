// SPDX-License-Identifier: Apache-2.0
// Half-edge collapses, one at a time.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "simplify/collapsing_mesh.h"
#include "support/surfaces.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using namespace test;

// The mesh without removed triangles and vertices.
TriangleMesh remaining(const CollapsingMesh& mesh) {
  TriangleMesh out;
  std::vector<std::uint32_t> number(mesh.positions().size(), kNone);
  for (const Triangle& t : mesh.triangles()) {
    if (CollapsingMesh::is_removed(t)) continue;
    Triangle& to = out.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& n = number[t[k]];
      if (n == kNone) {
        n = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(mesh.positions()[t[k]]);
      }
      to[k] = n;
    }
  }
  return out;
}

TriangleMesh random_mesh(std::uint64_t seed) {
  Random random(seed);
  const auto side = [&] { return static_cast<std::size_t>(random.between(3, 6)); };
  const Size size{side(), side(), side()};
  return triangles_of(
      surface_of(random_samples(static_cast<Family>(seed % kFamilies), size, random.bits())));
}

TEST(CollapsingMesh, PermittedCollapsesPreserveTheTopology) {
  std::size_t collapses = 0, refused = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const TriangleMesh mesh = random_mesh(seed);
    if (mesh.triangles.empty()) continue;
    const auto kinds = kinds_of(mesh);
    CollapsingMesh collapsing(mesh.positions, mesh.triangles, {1, 1, 1});
    Link link;
    Random random(seed + 1000);
    for (int step = 0; step < 200; ++step) {
      const auto v = static_cast<std::uint32_t>(random.bits() % mesh.positions.size());
      link.set(collapsing, v);
      if (link.vertices().empty()) continue;
      const std::uint32_t target = link.vertices()[random.bits() % link.vertices().size()];
      if (!link.permits(collapsing, target)) {
        ++refused;
        continue;
      }
      collapsing.apply({v, target});
      ++collapses;
    }
    ASSERT_EQ(text(kinds_of(remaining(collapsing))), text(kinds)) << seed;
  }
  EXPECT_GT(collapses, 1000u);
  EXPECT_GT(refused, 1000u);
}

// Every collapse that the link condition refuses would have changed the topology, except for those
// of boundary vertices into the surface or of the surface onto its boundary.
TEST(CollapsingMesh, RefusedCollapsesOfClosedMeshesChangeTheTopology) {
  std::size_t refused = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const TriangleMesh mesh = random_mesh(seed);
    CollapsingMesh collapsing(mesh.positions, mesh.triangles, {1, 1, 1});
    Link link;
    for (std::uint32_t v = 0; v < mesh.positions.size() && refused < 300; ++v) {
      link.set(collapsing, v);
      for (const std::uint32_t target : link.vertices()) {
        if (collapsing.is_on_boundary(v) || collapsing.is_on_boundary(target) ||
            link.permits(collapsing, target))
          continue;
        CollapsingMesh copy = collapsing;
        copy.apply({v, target});
        const MeshCounts counts = count_mesh(remaining(copy));
        EXPECT_TRUE(!counts.fault.empty() ||
                    counts.topology.kinds != count_mesh(mesh).topology.kinds)
            << seed << " " << v << " " << target;
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 50u);
}

TEST(CollapsingMesh, RevertedCollapsesLeaveNoTrace) {
  const TriangleMesh mesh = triangles_of(surface_of(sampled({9, 9, 9}, sphere({4, 4, 4}, 2.7))));
  CollapsingMesh collapsing(mesh.positions, mesh.triangles, {1, 1, 1});
  Link link;
  std::size_t reverted = 0;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    link.set(collapsing, v);
    const std::vector<std::uint32_t> targets(link.vertices().begin(), link.vertices().end());
    for (const std::uint32_t target : targets) {
      if (!link.permits(collapsing, target)) continue;
      const Collapse collapse{v, target};
      const std::vector<ChangedTriangle> changed = collapsing.apply(collapse);
      EXPECT_TRUE(collapsing.star(v).empty());
      collapsing.revert(collapse, changed);
      ++reverted;
    }
  }
  EXPECT_GT(reverted, 100u);
  EXPECT_TRUE(
      std::equal(mesh.triangles.begin(), mesh.triangles.end(), collapsing.triangles().begin()));
  const CollapsingMesh fresh(mesh.positions, mesh.triangles, {1, 1, 1});
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    std::vector<std::uint32_t> star(collapsing.star(v).begin(), collapsing.star(v).end());
    std::sort(star.begin(), star.end());
    EXPECT_TRUE(std::equal(star.begin(), star.end(), fresh.star(v).begin(), fresh.star(v).end()));
  }
}

}  // namespace
}  // namespace isoatlas::detail
