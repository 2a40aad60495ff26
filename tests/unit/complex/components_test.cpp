// SPDX-License-Identifier: Apache-2.0
// The components of surface complexes against shapes of known topology and an independent count.
#include "complex/components.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>

#include "support/reference_topology.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

void expect_like_count(const SurfaceComplex& surface, const std::string& what) {
  const MeshCounts counts = count_manifold(surface);
  const Components components = find_components(surface);
  EXPECT_EQ(components.of_c_vertex, counts.component_of_vertex) << what;
  EXPECT_EQ(components.topology, counts.components) << what;
}

TEST(Components, OfComplexesMadeByHand) {
  using Found = std::vector<ComponentTopology>;  // Euler characteristic, boundary loops
  EXPECT_EQ(find_components(tetrahedron()).topology, (Found{{2, 0}}));
  EXPECT_EQ(find_components(flat_grid(4, 3)).topology, (Found{{1, 1}}));
  EXPECT_EQ(find_components(tube(5, 4)).topology, (Found{{0, 2}}));
  EXPECT_TRUE(find_components(SurfaceComplex{}).topology.empty());
}

TEST(Components, OfKnownShapes) {
  for (const KnownVolume& known : known_volumes()) {
    const SurfaceComplex surface = surface_of(known.samples, known.isovalue);
    EXPECT_EQ(summarize(find_components(surface).topology).kinds, known.kinds) << known.name;
    expect_like_count(surface, known.name);
  }
}

TEST(Components, OfRandomVolumes) {
  for (std::uint64_t seed = 0; seed < 64; ++seed) {
    const auto family = static_cast<Family>(seed % kFamilies);
    const Samples s = random_samples(family, {2 + seed % 7, 8, 9}, seed);
    if (!has_surface(s, 0)) continue;
    expect_like_count(surface_of(s), std::string(name(family)) + " seed " + std::to_string(seed));
  }
}

// The independent count itself: topology by hand, and every planted fault.
TEST(CountManifold, OfComplexesMadeByHand) {
  using Kinds = std::vector<TopologySummary::Kind>;
  EXPECT_EQ(count_manifold(tetrahedron()).topology.kinds, (Kinds{{0, 0, 1}}));
  EXPECT_EQ(count_manifold(flat_grid(4, 3)).topology.kinds, (Kinds{{0, 1, 1}}));
  const MeshCounts ring = count_manifold(tube(5, 4));
  EXPECT_EQ(ring.topology.kinds, (Kinds{{0, 2, 1}}));
  EXPECT_EQ(ring.edges, 5u * 4 + 5 * 3);
  EXPECT_EQ(ring.boundary.size(), 10u);
}

TEST(CountManifold, RefusesFaults) {
  SurfaceComplex c = flat_grid(5, 5);
  c.faces.erase(c.faces.begin() + 5);
  EXPECT_THROW(count_manifold(c), std::runtime_error) << "sides around a hole are not listed";
  c = tetrahedron();
  std::swap(c.faces[1].corner[1], c.faces[1].corner[2]);
  EXPECT_THROW(count_manifold(c), std::runtime_error) << "a reversed face";
  c = flat_grid(3, 3);
  c.faces[0].corner[2] = c.faces[0].corner[0];
  EXPECT_THROW(count_manifold(c), std::runtime_error) << "a corner twice";
  c = tetrahedron();
  c.faces[1].corner[2] = 4;
  EXPECT_THROW(count_manifold(c), std::runtime_error) << "a corner out of range";
  c = flat_grid(4, 4);
  std::swap(c.boundary[0].from, c.boundary[0].to);
  EXPECT_THROW(count_manifold(c), std::runtime_error) << "a reversed boundary side";
  c = flat_grid(4, 4);
  c.on_boundary[5] = 1;
  EXPECT_THROW(count_manifold(c), std::runtime_error) << "an inner c-vertex with the flag";
  c = tetrahedron();
  c.positions.push_back({});
  c.on_boundary.push_back(0);
  EXPECT_THROW(count_manifold(c), std::runtime_error) << "a c-vertex in no face";
  c = flat_grid(2, 2);  // two quads that share a corner
  c.positions.resize(7);
  c.on_boundary.assign(7, 1);
  c.faces.push_back({{3, 4, 5, 6}});
  c.boundary.insert(c.boundary.end(), {{3, 4}, {4, 5}, {5, 6}, {6, 3}});
  EXPECT_THROW(count_manifold(c), std::runtime_error) << "two fans";
}

}  // namespace
}  // namespace isoatlas::detail
