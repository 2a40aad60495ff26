// SPDX-License-Identifier: Apache-2.0
// Volumes that are meshed block by block.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "isoatlas/blocks.h"
#include "support/mesh_counts.h"
#include "support/mesh_reference.h"
#include "support/surfaces.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using namespace test;

std::vector<BlockMesh> mesh_blocks(const Volume& volume, const BlockPlan& plan,
                                   const ExtractOptions& options) {
  std::vector<BlockMesh> out;
  for (std::size_t b = 0; b < plan.block_count(); ++b) {
    const BlockBox box = plan.block(b);
    out.push_back(mesh_block(volume.view.box(box.first, box.last), plan, b, options));
  }
  return out;
}

SamplesOfBlock boxes_of(const Volume& volume) {
  return [&](const BlockBox& box) { return Volume{volume.view.box(box.first, box.last), {}}; };
}

bool has_surface(const Samples& samples) {
  const auto [low, high] = std::minmax_element(samples.values.begin(), samples.values.end());
  return *low < 0 && *high >= 0;
}

// Empty, or what is wrong with the mesh of all blocks.
std::string what_is_wrong(const Extraction& merged, const TopologySummary& expected) {
  for (std::size_t k = 0; k < merged.hierarchy.levels.size(); ++k) {
    const std::string where = "level " + std::to_string(k) + ": ";
    const TriangleMesh mesh = merged.hierarchy.mesh(k);
    const LevelReport& report = merged.report.levels[k];
    const MeshCounts counts = count_mesh(mesh);
    if (!counts.fault.empty()) return where + counts.fault;
    if (counts.topology != expected)
      return where + text(counts.topology.kinds) + "instead of " + text(expected.kinds);
    if (report.topology != expected) return where + "the report has another topology";
    if (const std::size_t pairs = check_embedding(mesh).pairs; pairs != 0)
      return where + std::to_string(pairs) + " intersections";
    if (report.self_intersections != 0) return where + "the report has self-intersections";
    if (report.vertices != mesh.positions.size() || report.triangles != mesh.triangles.size())
      return where + "the report has other counts";
  }
  return "";
}

TEST(Blocks, RandomVolumes) {
  const std::uint64_t seeds = is_thorough() ? 32 : 8;
  std::size_t seams = 0, removed = 0;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    Random random(seed);
    const auto family = static_cast<Family>(seed % kFamilies);
    const auto side = [&] { return static_cast<std::size_t>(random.between(3, 8)); };
    const Size size{side(), side(), side()};
    const Samples samples = random_samples(family, size, random.bits());
    if (!has_surface(samples)) continue;
    const auto spacing = [&] { return 0.5 + random.unit(); };
    Volume volume = to_volume(samples, SampleType::int32, {spacing(), spacing(), spacing()});
    volume.view.grid.origin = {100 * random.unit(), -7, 3};
    if (seed % 3 == 0)
      volume.view.grid.direction = {Vec3{0.6, 0.8, 0}, Vec3{0.8, -0.6, 0}, Vec3{0, 0, 1}};
    ExtractOptions options;
    options.refine = {within(0.5 * vx)};
    options.surface.topology = seed / kFamilies % 2 == 0 ? Topology::trilinear : Topology::faces;
    options.surface.inside = seed % 5 == 0 ? Inside::below : Inside::above;
    options.space = seed % 4 == 0 ? Space::voxel : Space::ras;
    if (seed % 7 == 0) options.placement = Placement::balanced;
    const Extraction whole = extract(volume, options);
    const auto block = [&] { return static_cast<std::size_t>(random.between(1, 5)); };
    const BlockPlan plan(volume.view.grid, {block(), block(), block()});
    SCOPED_TRACE(std::string(name(family)) + " " + std::to_string(seed));
    const std::vector<BlockMesh> meshes = mesh_blocks(volume, plan, options);
    const Extraction merged = merge_blocks(plan, meshes, options),
                     simplified = merge_blocks(plan, meshes, options, {}, boxes_of(volume));
    for (const Extraction* each : {&merged, &simplified})
      ASSERT_EQ(what_is_wrong(*each, whole.report.reference), "")
          << name(family) << " " << seed << ", " << plan.block_count() << " blocks";
    // Removing vertices violates no bound, and reports no violation that is not there.
    const double bound = 0.5 * volume.view.grid.smallest_spacing();
    const auto reached = [](const Extraction& it) {
      return it.report.levels[1].constraints[0].reached;
    };
    EXPECT_LE(reached(simplified), std::max(bound, reached(merged))) << seed;
    seams += merged.report.blocks->seam_edges;
    removed += simplified.report.blocks->removed_vertices;
  }
  EXPECT_GT(seams, 10 * seeds);
  EXPECT_GT(removed, seeds);
}

std::vector<BlockMesh> example(const BlockPlan& plan, double isovalue,
                               const ExtractOptions& base = {}) {
  ExtractOptions options = base;
  options.surface.isovalue = isovalue;
  return mesh_blocks(to_volume(sampled({12, 10, 9}, torus({5.5, 4.5, 4}, 3, 1.2))), plan, options);
}

BlockPlan example_plan(Size3 block_size = {5, 4, 8}) {
  Grid grid;
  grid.size = {12, 10, 9};
  return BlockPlan(grid, block_size);
}

std::string message(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Blocks, PlanCoversEachGridCellOnce) {
  for (const Size3 block : {Size3{1, 1, 1}, Size3{3, 2, 4}, Size3{11, 9, 8}, Size3{100, 5, 7}}) {
    const BlockPlan plan = example_plan(block);
    std::vector<int> cells(11 * 9 * 8, 0);
    for (std::size_t b = 0; b < plan.block_count(); ++b) {
      const BlockBox box = plan.block(b);
      for (std::size_t z = box.first[2]; z < box.last[2]; ++z)
        for (std::size_t y = box.first[1]; y < box.last[1]; ++y)
          for (std::size_t x = box.first[0]; x < box.last[0]; ++x) ++cells[x + 11 * (y + 9 * z)];
    }
    EXPECT_EQ(cells, std::vector<int>(cells.size(), 1)) << block[0];
  }
}

TEST(Blocks, OneBlockIsTheWholeVolume) {
  ExtractOptions options;
  options.refine = {within(1.0), within(0.2)};
  const Volume volume = to_volume(sampled({12, 10, 9}, torus({5.5, 4.5, 4}, 3, 1.2)));
  const Extraction whole = extract(volume, options);
  const BlockPlan plan = example_plan({20, 20, 20});
  ASSERT_EQ(plan.block_count(), 1u);
  const Extraction merged = merge_blocks(plan, mesh_blocks(volume, plan, options), options);
  EXPECT_EQ(merged.hierarchy.positions, whole.hierarchy.positions);
  EXPECT_EQ(merged.hierarchy.parent, whole.hierarchy.parent);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_EQ(merged.hierarchy.levels[k].triangles, whole.hierarchy.levels[k].triangles) << k;
  EXPECT_EQ(merged.report.reference, whole.report.reference);
  EXPECT_EQ(merged.report.c_vertices, whole.report.c_vertices);
}

TEST(Blocks, LevelsAreNestedAndWithinTheirBounds) {
  ExtractOptions options;
  options.refine = {within(1.0), within(0.45)};
  const BlockPlan plan = example_plan();
  const Extraction merged = merge_blocks(plan, example(plan, 0, options), options);
  const Hierarchy& hierarchy = merged.hierarchy;
  ASSERT_EQ(hierarchy.levels.size(), 3u);
  for (std::size_t k = 1; k < 3; ++k) {
    EXPECT_LE(hierarchy.levels[k - 1].vertex_count, hierarchy.levels[k].vertex_count);
    ASSERT_TRUE(merged.report.levels[k].distance_at_most);
    EXPECT_LE(*merged.report.levels[k].distance_at_most, k == 1 ? 1.0 : 0.45);
  }
  for (std::uint32_t v = 0; v < hierarchy.parent.size(); ++v)
    EXPECT_LT(hierarchy.parent[v], hierarchy.levels[1].vertex_count);
}

// The vertices of a coarser level are the first ones, at the same positions, and parents are
// vertices of the previous level.
TEST(Blocks, SeamsLeaveNoTrace) {
  const Volume volume = to_volume(sampled({40, 36, 30}, torus({19.5, 17.5, 14.5}, 11, 4.7)));
  const BlockPlan plan(volume.view.grid, {16, 16, 16});
  ExtractOptions options;
  options.refine = {within(1.0), within(0.5)};
  const std::vector<BlockMesh> meshes = mesh_blocks(volume, plan, options);
  const Extraction merged = merge_blocks(plan, meshes, options),
                   simplified = merge_blocks(plan, meshes, options, {}, boxes_of(volume));
  const Extraction whole = extract(volume, options);
  ASSERT_EQ(what_is_wrong(simplified, whole.report.reference), "");
  const Hierarchy& hierarchy = simplified.hierarchy;
  ASSERT_EQ(hierarchy.levels.size(), 3u);
  EXPECT_EQ(hierarchy.positions.size() + simplified.report.blocks->removed_vertices,
            merged.hierarchy.positions.size());
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t before = k == 0 ? 0 : hierarchy.levels[k - 1].vertex_count;
    ASSERT_LE(before, hierarchy.levels[k].vertex_count);
    for (std::uint32_t v = before; v < hierarchy.levels[k].vertex_count; ++v) {
      EXPECT_LT(hierarchy.parent[v], k == 0 ? v + 1 : before);
    }
    EXPECT_LT(2 * hierarchy.levels[k].vertex_count, merged.hierarchy.levels[k].vertex_count) << k;
    if (k == 0) continue;
    MeasureOptions measured;
    measured.samples = 50000;
    const double bound = k == 1 ? 1.0 : 0.5;
    EXPECT_LE(measure(hierarchy.mesh(k), volume, measured).maximum(), bound);
    ASSERT_TRUE(simplified.report.levels[k].distance_at_most);
    EXPECT_LE(*simplified.report.levels[k].distance_at_most, bound);
  }
}

// Vertices of level 0 next to shared faces must not be moved off the surface, where later levels
// could not correct them: then there is no proof for these volumes.
TEST(Blocks, ABoundThatIsProvedForTheWholeIsProvedInBlocks) {
  ExtractOptions options;
  options.refine = {within(0.5)};
  for (const std::uint64_t seed : {0, 3, 8, 9}) {
    const Volume volume = to_volume(random_samples(Family::white_noise, {9, 9, 9}, seed));
    ASSERT_TRUE(extract(volume, options).report.levels.back().distance_at_most) << seed;
    const Extraction blocks = extract_in_blocks(volume, {4, 4, 4}, options);
    EXPECT_TRUE(blocks.report.levels.back().distance_at_most) << seed;
  }
}

TEST(Blocks, TheOrderDoesNotMatter) {
  const BlockPlan plan = example_plan();
  std::vector<BlockMesh> meshes = example(plan, 0);
  const Volume volume = to_volume(sampled({12, 10, 9}, torus({5.5, 4.5, 4}, 3, 1.2)));
  const Extraction one = merge_blocks(plan, meshes, {}, {}, boxes_of(volume));
  std::reverse(meshes.begin(), meshes.end());
  const Extraction other = merge_blocks(plan, std::move(meshes), {}, {}, boxes_of(volume));
  EXPECT_EQ(one.hierarchy.positions, other.hierarchy.positions);
  EXPECT_EQ(one.hierarchy.levels.back().triangles, other.hierarchy.levels.back().triangles);
  std::size_t finished = 0;
  const Extraction loop = extract_in_blocks(volume, plan.block_size(), {}, {},
                                            [&](std::size_t b) { EXPECT_EQ(b, finished++); });
  EXPECT_EQ(finished, plan.block_count());
  EXPECT_EQ(one.hierarchy.positions, loop.hierarchy.positions);
}

TEST(Blocks, BlocksThatDoNotFitAreNamed) {
  const BlockPlan plan = example_plan();
  const std::vector<BlockMesh> meshes = example(plan, 0);
  const auto merged = [&](const std::function<void(std::vector<BlockMesh>&)>& change) {
    std::vector<BlockMesh> changed = meshes;
    change(changed);
    return message([&] { merge_blocks(plan, std::move(changed), {}); });
  };
  EXPECT_EQ(merged([](auto& m) { m.erase(m.begin() + 1); }), "block 1 is missing");
  EXPECT_EQ(merged([](auto& m) { m.pop_back(); }),
            "block " + std::to_string(plan.block_count() - 1) + " is missing");
  EXPECT_EQ(merged([](auto& m) { m[1] = m[0]; }), "block 0 is there twice");
  EXPECT_NE(merged([&](auto& m) { m[1] = example(plan, 300)[1]; }).find("does not fit"),
            std::string::npos);
  ExtractOptions coarse;
  coarse.refine.clear();
  EXPECT_EQ(merged([&](auto& m) { m[1] = example(plan, 0, coarse)[1]; }),
            "block 1 has 1 levels, expected 2");
  EXPECT_EQ(message([&] { merge_blocks(plan, example(plan, 1e6), {}); }),
            "the surface crosses none of the 9 blocks");
}

TEST(Blocks, OptionsThatNeedTheWholeSurfaceAreRefused) {
  const BlockPlan plan = example_plan();
  const auto refused = [&](const std::function<void(ExtractOptions&)>& change) {
    ExtractOptions options;
    change(options);
    return message([&] { example(plan, 0, options); });
  };
  const std::string end = " cannot be had in blocks";
  EXPECT_EQ(refused([](auto& o) { o.supersample = 2; }), "supersampling" + end);
  EXPECT_EQ(refused([](auto& o) { o.border = Border::closed; }),
            "a surface closed on the volume boundary" + end);
  EXPECT_EQ(refused([](auto& o) { o.components.keep_largest = 1; }),
            "a choice of components" + end);
  EXPECT_EQ(refused([](auto& o) { o.allow_self_intersections = true; }),
            "a mesh with self-intersections" + end);
  EXPECT_EQ(refused([](auto& o) { o.measure_samples = 100; }), "a measurement of distances" + end);
  EXPECT_EQ(refused([](auto& o) { o.refine = {bounded(Quantity::max_vertices, 100)}; }),
            "a bound on the number of vertices" + end);
}

TEST(Blocks, BadPlansAndSamplesAreRefused) {
  Grid grid;
  grid.size = {12, 10, 9};
  EXPECT_EQ(message([&] {
              BlockPlan(grid, {0, 4, 4});
            }),
            "a block of 0 x 4 x 4 grid cells is empty; expected at least 1 along each axis");
  const BlockPlan plan = example_plan();
  EXPECT_EQ(message([&] { plan.block(99); }), "there is no block 99; the blocks are 0 to 8");
  const Volume volume = to_volume(sampled({12, 10, 9}, torus({5.5, 4.5, 4}, 3, 1.2)));
  EXPECT_EQ(message([&] { mesh_block(volume, plan, 0, {}); }),
            "block 0 has 6 x 5 x 9 samples, but those given are 12 x 10 x 9");
}

TEST(Blocks, NonFiniteSamplesAreNamedByTheirBlock) {
  Grid grid;
  grid.size = {12, 10, 9};
  std::vector<float> samples(grid.sample_count(), 1);
  samples[7 + 12 * (6 + 10 * 3)] = NAN;
  const Volume volume = own(grid, SampleType::float32, samples);
  const BlockPlan plan(grid, {5, 4, 8});
  const std::string found = message([&] { mesh_blocks(volume, plan, {}); });
  EXPECT_EQ(found.find("block 4, which begins at sample (5, 4, 0): "), 0u) << found;
  ExtractOptions options;
  options.surface.isovalue = 0.5;
  options.surface.non_finite = NonFinite::below;
  const Extraction merged = merge_blocks(plan, mesh_blocks(volume, plan, options), options);
  EXPECT_EQ(merged.report.reference, extract(volume, options).report.reference);
}

TEST(Blocks, TheirSizeForAnAmountOfMemory) {
  Grid grid;
  grid.size = {2048, 2048, 1024};
  const Size3 some = block_size_for(grid, SampleType::uint8, std::uint64_t{1} << 30);
  EXPECT_EQ(some[0], some[1]);
  EXPECT_GT(some[0], 200u);
  EXPECT_LT(some[0], 500u);
  EXPECT_EQ(block_size_for(grid, SampleType::uint8, std::uint64_t{1} << 50),
            (Size3{2047, 2047, 1023}));
  grid.size = {2048, 2048, 20};
  const Size3 flat = block_size_for(grid, SampleType::uint8, std::uint64_t{1} << 30);
  EXPECT_EQ(flat[2], 19u);
  EXPECT_GT(flat[0], 1000u);
}

}  // namespace
}  // namespace isoatlas::detail
