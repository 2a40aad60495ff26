// SPDX-License-Identifier: Apache-2.0
// Sizes of components against closed forms, and what is left when some go.
#include "surface/drop_components.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/surfaces.h"
#include "support/volumes.h"

namespace isoatlas {
namespace {

using namespace test;

double ball(double radius) { return 4 * std::numbers::pi / 3 * radius * radius * radius; }

TEST(ComponentVolumes, OfBallsShellsAndHalfSpaces) {
  const Function balls = unite(sphere({8.3, 8.4, 8.6}, 6), sphere({22.4, 8.5, 8.3}, 3));
  const SurfaceComplex two = surface_of(sampled({28, 18, 18}, balls), 0, Inside::above, {1, 2, 0.5});
  const std::vector<double> sizes = component_volumes(two, find_components(two));
  ASSERT_EQ(sizes.size(), 2u);
  EXPECT_NEAR(std::max(sizes[0], sizes[1]), ball(6), 0.04 * ball(6)) << "a spacing of volume 1; chords cut off a little";
  EXPECT_NEAR(std::min(sizes[0], sizes[1]), ball(3), 0.12 * ball(3));

  // A hollow is a component of its own, as large as what it leaves out.
  const SurfaceComplex shells = surface_of(sampled({24, 24, 24}, nested_shells({11.4, 11.6, 11.3}, {9, 5})));
  const std::vector<double> nested = component_volumes(shells, find_components(shells));
  ASSERT_EQ(nested.size(), 2u);
  EXPECT_NEAR(std::max(nested[0], nested[1]), ball(9), 0.02 * ball(9));
  EXPECT_NEAR(std::min(nested[0], nested[1]), ball(5), 0.05 * ball(5));

  // Cut open: an area of 15 x 15 is that of a ball of radius sqrt(225 / 4 pi).
  const SurfaceComplex sheet = surface_of(sampled({16, 16, 16}, half_space({0, 0, 1}, 7.5)));
  const std::vector<double> open = component_volumes(sheet, find_components(sheet));
  ASSERT_EQ(open.size(), 1u);
  EXPECT_NEAR(open[0], ball(std::sqrt(225 / (4 * std::numbers::pi))), 1e-6 * open[0]);
}

TEST(DropComponents, LeavesTheOthersAsTheyWere) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const SurfaceComplex whole = surface_of(random_samples(Family::white_noise, {8, 7, 9}, seed));
    const Components components = find_components(whole);
    std::vector<std::uint8_t> goes(components.topology.size());
    for (std::size_t c = 0; c < goes.size(); ++c) goes[c] = (c + seed) % 3 == 0;
    SurfaceComplex rest = whole;
    drop_components(rest, components, goes);
    if (rest.faces.empty()) continue;
    EXPECT_EQ(validate(rest), "");
    std::vector<ComponentTopology> want;
    for (std::size_t c = 0; c < goes.size(); ++c) {
      if (!goes[c]) want.push_back(components.topology[c]);
    }
    EXPECT_EQ(find_components(rest).topology, want) << "in the same order";
    std::size_t v = 0;
    for (CVertexId old = 0; old < whole.c_vertex_count(); ++old) {
      if (goes[components.of_c_vertex[old]]) continue;
      ASSERT_EQ(rest.positions[v], whole.positions[old]);
      ASSERT_EQ(rest.on_boundary[v], whole.on_boundary[old]);
      ++v;
    }
    EXPECT_EQ(v, rest.c_vertex_count());
  }
}

}  // namespace
}  // namespace isoatlas
