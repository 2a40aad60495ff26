// SPDX-License-Identifier: Apache-2.0
// The remaining surface after some of its components were removed.
#include "complex/drop_components.h"

#include <gtest/gtest.h>

#include "support/surfaces.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using namespace test;

TEST(DropComponents, KeepsTheOtherComponents) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const SurfaceComplex whole = surface_of(random_samples(Family::white_noise, {8, 7, 9}, seed));
    const MeshCounts counts = count_manifold(whole);
    std::vector<std::uint8_t> goes(counts.components.size());
    for (std::size_t c = 0; c < goes.size(); ++c) goes[c] = (c + seed) % 3 == 0;
    SurfaceComplex rest = whole;
    drop_components(rest, find_components(whole), goes);
    if (rest.faces.empty()) continue;
    EXPECT_EQ(validate(rest), "");
    std::vector<ComponentTopology> want;
    for (std::size_t c = 0; c < goes.size(); ++c) {
      if (!goes[c]) want.push_back(counts.components[c]);
    }
    EXPECT_EQ(count_manifold(rest).components, want) << "in the same order";
    std::size_t v = 0;
    for (CVertexId old = 0; old < whole.c_vertex_count(); ++old) {
      if (goes[counts.component_of_vertex[old]]) continue;
      ASSERT_EQ(rest.positions[v], whole.positions[old]);
      ASSERT_EQ(rest.on_boundary[v], whole.on_boundary[old]);
      ++v;
    }
    EXPECT_EQ(v, rest.c_vertex_count());
  }
}

}  // namespace
}  // namespace isoatlas::detail
