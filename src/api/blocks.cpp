// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/blocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "api/extract_block.h"
#include "api/resolve_options.h"
#include "core/require.h"
#include "core/vector_math.h"

namespace isoatlas {
using namespace detail;
namespace {

// With at most this many samples along an axis, the positions of c-vertices, which are multiples of
// 2^-32, are exact in the whole volume.
constexpr std::size_t kMaxSamples = std::size_t{1} << 20;

std::string text(const Size3& size) {
  return std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " +
         std::to_string(size[2]);
}

// The positions in the report of a block, in sample-index coordinates.
void add_to_positions(ExtractReport& report, Vec3 by) {
  for (LevelReport& level : report.levels) {
    for (CellAtLimit& cell : level.at_limit) cell.position = cell.position + by;
    for (BadTriangle& triangle : level.bad_triangles) triangle.position = triangle.position + by;
    for (Vec3& position : level.self_intersection_positions) position = position + by;
    level.extent.bounds.low = level.extent.bounds.low + by;
    level.extent.bounds.high = level.extent.bounds.high + by;
    for (ComponentExtent& component : level.extent.largest) {
      component.bounds.low = component.bounds.low + by;
      component.bounds.high = component.bounds.high + by;
    }
  }
}

}  // namespace

BlockPlan::BlockPlan(const Grid& grid, const Size3& block_size)
    : grid_(grid), block_size_(block_size) {
  for (std::size_t a = 0; a < 3; ++a) {
    require(block_size[a] > 0, "a block of " + text(block_size) +
                                   " grid cells is empty; expected at least 1 along each axis");
    require(grid.size[a] >= 2,
            "the volume has " + text(grid.size) + " samples; expected at least 2 along each axis");
    if (grid.size[a] > kMaxSamples)
      throw Error(ErrorCode::unsupported, "the volume has " + text(grid.size) +
                                              " samples; blocks need at most 2^20 along each axis");
    block_size_[a] = std::min(block_size[a], grid.size[a] - 1);
    counts_[a] = (grid.size[a] - 2) / block_size_[a] + 1;
  }
}

BlockBox BlockPlan::block(std::size_t index) const {
  require(index < block_count(), "there is no block " + std::to_string(index) +
                                     "; the blocks are 0 to " + std::to_string(block_count() - 1));
  BlockBox out;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t at = index % counts_[a];
    index /= counts_[a];
    out.first[a] = at * block_size_[a];
    out.last[a] = std::min(out.first[a] + block_size_[a], grid_.size[a] - 1);
  }
  return out;
}

BlockMesh mesh_block(const VolumeView& samples, const BlockPlan& plan, std::size_t block,
                     const ExtractOptions& options, const RunControl& control) {
  const BlockBox box = plan.block(block);
  const Grid& whole = plan.grid();
  BlockPlace place{{}, whole, {}, options.space};
  VolumeView view = samples;
  view.grid = whole;
  for (std::size_t a = 0; a < 3; ++a) {
    view.grid.size[a] = box.last[a] - box.first[a] + 1;
    place.shared[a] = {box.first[a] > 0, box.last[a] + 1 < whole.size[a]};
  }
  require(samples.grid.size == view.grid.size,
          "block " + std::to_string(block) + " has " + text(view.grid.size) +
              " samples, but those given are " + text(samples.grid.size));
  const auto first = [&](std::size_t a) { return static_cast<double>(box.first[a]); };
  place.first = {first(0), first(1), first(2)};
  view.grid.origin = whole.to_world(place.first);
  ExtractOptions in_block = options;
  in_block.space = Space::voxel;

  Extraction made;
  try {
    made = extract_block(view, in_block, place, control);
  } catch (const Error& error) {
    if (error.remedy() != Remedy::place_nan) throw;
    throw error.with_prefix("block " + std::to_string(block) + ", which begins at sample (" +
                            std::to_string(box.first[0]) + ", " + std::to_string(box.first[1]) +
                            ", " + std::to_string(box.first[2]) + "): ");
  }
  BlockMesh out{block, std::move(made.hierarchy), std::move(made.report)};
  out.hierarchy.float32_origin.reset();
  for (Vec3& p : out.hierarchy.positions) p = p + place.first;
  for (Hierarchy::Level& level : out.hierarchy.levels) {
    for (Vec3& p : level.own_positions) p = p + place.first;
  }
  add_to_positions(out.report, place.first);
  return out;
}

Size3 block_size_for(const Grid& grid, SampleType type, std::uint64_t bytes) {
  // Estimates, not measured.
  constexpr double kBytesPerCVertex = 700, kCVerticesPerCell = 0.05;
  const double per_cell =
      static_cast<double>(bytes_per_sample(type)) + kBytesPerCVertex * kCVerticesPerCell;
  const double cells = std::max(1.0, static_cast<double>(bytes) / per_cell);
  Size3 out;
  double whole = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    out[a] = grid.size[a] - 1;
    whole *= static_cast<double>(out[a]);
  }
  if (whole <= cells) return out;
  // Cubes, but for axes that are shorter.
  std::array<std::size_t, 3> axes{0, 1, 2};
  std::sort(axes.begin(), axes.end(),
            [&](std::size_t a, std::size_t b) { return out[a] < out[b]; });
  double left = cells;
  for (std::size_t k = 0; k < 3; ++k) {
    const double side = std::floor(std::pow(left, 1.0 / static_cast<double>(3 - k)));
    std::size_t& n = out[axes[k]];
    n = std::max<std::size_t>(1, std::min(n, static_cast<std::size_t>(side)));
    left /= static_cast<double>(n);
  }
  return out;
}

Extraction extract_in_blocks(const BlockPlan& plan, const SamplesOfBlock& samples_of,
                             const ExtractOptions& options, const RunControl& control,
                             const std::function<void(std::size_t)>& finished) {
  const auto count = static_cast<double>(plan.block_count());
  std::vector<BlockMesh> meshes;
  for (std::size_t b = 0; b < plan.block_count(); ++b) {
    RunControl part = control;
    if (control.progress) {
      part.progress = [&, b](std::string_view, double fraction) {
        control.progress("blocks", (static_cast<double>(b) + fraction) / count);
      };
    }
    const Volume samples = samples_of(plan.block(b));
    meshes.push_back(mesh_block(samples, plan, b, options, part));
    if (finished) finished(b);
  }
  RunControl quiet = control;
  quiet.progress = nullptr;
  control.report("merge", 1);
  return merge_blocks(plan, std::move(meshes), options, quiet, samples_of);
}

Extraction extract_in_blocks(const VolumeView& volume, const Size3& block_size,
                             const ExtractOptions& options, const RunControl& control,
                             const std::function<void(std::size_t)>& finished) {
  const auto box = [&](const BlockBox& block) {
    return Volume{volume.box(block.first, block.last), {}};
  };
  return extract_in_blocks(BlockPlan(volume.grid, block_size), box, options, control, finished);
}

}  // namespace isoatlas
