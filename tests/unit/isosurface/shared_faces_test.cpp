// SPDX-License-Identifier: Apache-2.0
// The surfaces of the blocks of a volume: they have the same points on shared faces, and their
// union is the surface of the volume.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <string>
#include <vector>

#include "field/dense_volume.h"
#include "isosurface/parse_surface.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;
using Point = std::array<double, 3>;

struct Block {
  std::array<std::size_t, 3> first, last;  // samples, both included
  SurfaceComplex surface;

  Point point(CVertexId v) const {
    const Vec3 p = surface.positions[v];
    return {static_cast<double>(first[0]) + p.x, static_cast<double>(first[1]) + p.y,
            static_cast<double>(first[2]) + p.z};
  }
};

// Per axis, the planes of samples at which a volume is cut.
using Cuts = std::array<std::vector<std::size_t>, 3>;

std::vector<Block> blocks_of(const Volume& volume, ParseOptions options, const Cuts& cuts,
                             bool shares = true) {
  const auto end = [&](std::size_t axis, std::size_t i) {
    return i < cuts[axis].size() ? cuts[axis][i] : volume.view.grid.size[axis] - 1;
  };
  std::vector<Block> out;
  for (std::size_t k = 0; k <= cuts[2].size(); ++k)
    for (std::size_t j = 0; j <= cuts[1].size(); ++j)
      for (std::size_t i = 0; i <= cuts[0].size(); ++i) {
        Block block;
        const std::array<std::size_t, 3> at{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          block.first[a] = at[a] == 0 ? 0 : end(a, at[a] - 1);
          block.last[a] = end(a, at[a]);
          options.shared[a] = {shares && at[a] > 0, shares && at[a] < cuts[a].size()};
        }
        const Volume part =
            dense_volume(volume.view.box(Size3(block.first[0], block.first[1], block.first[2]),
                                         Size3(block.last[0], block.last[1], block.last[2])));
        block.surface = parse_surface(part.view, options);
        out.push_back(std::move(block));
      }
  return out;
}

// The union of the blocks' surfaces: boundary c-vertices at the same place are one.
MeshCounts count_union(const std::vector<Block>& blocks) {
  std::map<Point, std::uint32_t> at;
  std::vector<std::vector<std::uint32_t>> faces;
  std::uint32_t count = 0;
  for (const Block& block : blocks) {
    const SurfaceComplex& surface = block.surface;
    std::vector<std::uint32_t> id(surface.c_vertex_count());
    for (CVertexId v = 0; v < surface.c_vertex_count(); ++v) {
      if (!surface.on_boundary[v])
        id[v] = count++;
      else if (const auto [found, is_new] = at.try_emplace(block.point(v), count); is_new)
        id[v] = count++;
      else
        id[v] = found->second;
    }
    for (const Face& face : surface.faces) {
      std::vector<std::uint32_t>& corners = faces.emplace_back();
      for (int k = 0; k < face.size(); ++k)
        corners.push_back(id[face.corner[static_cast<std::size_t>(k)]]);
    }
  }
  return count_polygons(count, {faces.begin(), faces.end()});
}

std::size_t random_cut(Random& random, std::size_t size) {
  return static_cast<std::size_t>(random.between(1, static_cast<std::int64_t>(size) - 2));
}

TEST(SharedFaces, TheUnionOfTheBlocksIsTheSurfaceOfTheVolume) {
  Random random(17);
  int faulty_without = 0;
  for (std::uint64_t seed = 0; seed < 1200; ++seed) {
    const Family family = static_cast<Family>(seed % kFamilies);
    Size size;
    for (std::size_t& n : size) n = static_cast<std::size_t>(random.between(3, 8));
    const Samples samples = random_samples(family, size, seed);
    const Volume volume = to_volume(samples);
    ParseOptions options;
    options.topology = seed / kFamilies % 2 == 0 ? Topology::trilinear : Topology::faces;
    options.rule.inside = seed / 3 % 2 == 0 ? Inside::above : Inside::below;
    options.vertices_on_surface = seed % 5 != 0;
    const SurfaceComplex whole = parse_surface(volume.view, options);
    if (whole.faces.empty()) continue;
    Cuts cuts;
    for (std::size_t a = 0; a < 3; ++a)
      if (a == seed % 3 || seed % 2 == 0) cuts[a].push_back(random_cut(random, size[a]));
    const std::vector<Block> blocks = blocks_of(volume, options, cuts);
    const std::string what = std::string(name(family)) + " " + std::to_string(seed);
    for (const Block& block : blocks)
      if (!block.surface.faces.empty()) {
        ASSERT_EQ(validate(block.surface), "") << what;
      }
    const MeshCounts got = count_union(blocks);
    ASSERT_EQ(got.fault, "") << what;
    const TopologySummary want = count_manifold(whole).topology;
    ASSERT_EQ(got.topology, want) << what << ": " << text(got.topology.kinds) << "instead of "
                                  << text(want.kinds);
    faulty_without += !count_union(blocks_of(volume, options, cuts, false)).fault.empty();
  }
  // Without it, nodes are c-vertices where one of the blocks needs them.
  EXPECT_GT(faulty_without, 100);
}

}  // namespace
}  // namespace isoatlas::detail
