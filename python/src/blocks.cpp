// SPDX-License-Identifier: Apache-2.0
#include "blocks.h"

#include <string_view>

#include "array_volume.h"
#include "interruptible.h"
#include "isoatlas/error.h"
#include "isoatlas/version.h"
#include "outputs/mesh_outputs.h"
#include "settings_of_words.h"
#include "stored/archive.h"

namespace isoatlas::detail::python {
namespace {

constexpr std::string_view kBlockData = "the data of a block";

Grid grid_of(const std::array<std::size_t, 3>& shape, const std::string& order,
             const std::array<double, 3>& spacing, const std::array<double, 3>& origin,
             const std::array<std::array<double, 3>, 3>& direction, const std::string& unit) {
  if (order != "ijk" && order != "xyz")
    throw Error(ErrorCode::bad_argument, "order: expected one of ijk, xyz, got '" + order + "'");
  Grid grid;
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.size[order == "ijk" ? axis : 2 - axis] = shape[axis];
  grid.spacing = {spacing[0], spacing[1], spacing[2]};
  grid.origin = {origin[0], origin[1], origin[2]};
  grid.unit = length_unit_named(unit);
  for (std::size_t k = 0; k < 3; ++k)
    grid.direction[k] = {direction[0][k], direction[1][k], direction[2][k]};
  return grid;
}

// The library's x axis is the last axis of a C-contiguous array.
Axes axes_of(const std::string& order) {
  return Axes(order == "ijk" ? std::array{2, 1, 0} : std::array{0, 1, 2});
}

}  // namespace

BlockedArray::BlockedArray(const std::array<std::size_t, 3>& shape, const py::dtype& dtype,
                           const std::array<std::size_t, 3>& blocks, const std::string& order,
                           const std::array<double, 3>& spacing,
                           const std::array<double, 3>& origin,
                           const std::array<std::array<double, 3>, 3>& direction,
                           const std::string& unit, const ExtractWords& words)
    : grid_(grid_of(shape, order, spacing, origin, direction, unit)),
      axes_(axes_of(order)),
      is_xyz_(order == "xyz"),
      type_(sample_type_of(dtype)),
      plan_(axes_.to_library(grid_), Size3(blocks[2], blocks[1], blocks[0])) {
  const ExtractSettings settings = settings_of(words);
  threads_ = settings.threads;
  options_ = in_world(settings, plan_.grid());
  if (options_.space == Space::ras && !is_xyz_)
    throw Error(ErrorCode::bad_argument,
                "space: ras needs the coordinates x, y, z, expected order='xyz' with it");
}

std::array<std::pair<std::size_t, std::size_t>, 3> BlockedArray::slices(std::size_t block) const {
  const BlockBox box = plan_.block(block);
  std::array<std::pair<std::size_t, std::size_t>, 3> out;
  for (std::size_t axis = 0; axis < 3; ++axis)
    out[axis] = {box.first[2 - axis], box.last[2 - axis] + 1};
  return out;
}

py::bytes BlockedArray::mesh(std::size_t block, const py::array& samples) const {
  const auto slices_of_block = slices(block);
  bool fits = samples.ndim() == 3 && (samples.flags() & py::array::c_style) != 0 &&
              sample_type_of(samples.dtype()) == type_;
  for (std::size_t axis = 0; fits && axis < 3; ++axis) {
    const auto [first, end] = slices_of_block[axis];
    fits = static_cast<std::size_t>(samples.shape(static_cast<py::ssize_t>(axis))) == end - first;
  }
  if (!fits)
    throw Error(ErrorCode::bad_argument,
                "block " + std::to_string(block) + " has another shape or type than its samples");
  VolumeView view;
  view.grid = plan_.grid();
  for (std::size_t axis = 0; axis < 3; ++axis)
    view.grid.size[2 - axis] = slices_of_block[axis].second - slices_of_block[axis].first;
  view.type = type_;
  view.samples = samples.data();
  ExtractOptions options = options_;
  options.space = axes_.space_in_library(options.space);
  const auto work = [view, options, plan = plan_, block](const RunControl& control) {
    return bytes_of(mesh_block(view, plan, block, options, control));
  };
  return compute_interruptibly(work, {.threads = threads_, .keep_alive = samples});
}

std::shared_ptr<Levels> BlockedArray::merge(const std::vector<py::bytes>& stored,
                                            const py::object& progress) const {
  const auto bytes = std::make_shared<std::vector<std::string>>();
  for (const py::bytes& it : stored) bytes->emplace_back(std::string_view(it));
  ExtractOptions options = options_;
  options.space = axes_.space_in_library(options.space);
  const auto work = [bytes, options, plan = plan_](const RunControl& control) {
    std::vector<BlockMesh> meshes;
    for (std::string& it : *bytes) {
      meshes.push_back(from_bytes<BlockMesh>(it, kBlockData));
      require_corners_in_range(meshes.back().hierarchy, kBlockData);
      it = {};
    }
    return merge_blocks(plan, std::move(meshes), options, control);
  };
  Extraction extraction = compute_interruptibly(work, {.progress = progress, .threads = threads_});
  axes_.to_caller(extraction, options_.space);
  auto levels = std::make_shared<Levels>();
  Levels::Extracted& extracted = levels->extracted.emplace();
  extracted.context.volume.grid = grid_;
  extracted.context.volume.sample_type = type_;
  extracted.context.options = options_;
  extracted.context.threads = threads_;
  extracted.context.peak_memory_bytes = peak_memory_bytes();
  levels->hierarchy = std::move(extraction.hierarchy);
  extracted.report = std::move(extraction.report);
  levels->info = file_info(extracted.report, options_, grid_.unit);
  if (!is_xyz_ && options_.space != Space::voxel)
    levels->info.mesh.space.clear();  // the meaning of the array's axes is unknown
  return levels;
}

}  // namespace isoatlas::detail::python
