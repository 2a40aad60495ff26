// SPDX-License-Identifier: Apache-2.0
#include "blocks.h"

#include <cstddef>
#include <cstring>
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

Slices slices_of(const BlockBox& box) {
  Slices out;
  for (std::size_t axis = 0; axis < 3; ++axis)
    out[axis] = {box.first[2 - axis], box.last[2 - axis] + 1};
  return out;
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

Slices BlockedArray::slices(std::size_t block) const { return slices_of(plan_.block(block)); }

// @param name  of the box, for messages
VolumeView BlockedArray::view_of(const py::array& samples, const Slices& slices,
                                 const std::string& name) const {
  bool fits = samples.ndim() == 3 && (samples.flags() & py::array::c_style) != 0 &&
              sample_type_of(samples.dtype()) == type_;
  for (std::size_t axis = 0; fits && axis < 3; ++axis) {
    const auto [first, end] = slices[axis];
    fits = static_cast<std::size_t>(samples.shape(static_cast<py::ssize_t>(axis))) == end - first;
  }
  if (!fits)
    throw Error(ErrorCode::bad_argument, name + " has another shape or type than its samples");
  VolumeView view;
  view.grid = plan_.grid();
  for (std::size_t axis = 0; axis < 3; ++axis)
    view.grid.size[2 - axis] = slices[axis].second - slices[axis].first;
  view.type = type_;
  view.samples = samples.data();
  return view;
}

// A copy of the samples of a box. The caller does not hold the interpreter's lock.
Volume BlockedArray::samples_in(const BlockBox& box, py::handle samples) const {
  const py::gil_scoped_acquire lock;
  const Slices slices = slices_of(box);
  const py::array array(samples(slices[0], slices[1], slices[2]));
  VolumeView view = view_of(array, slices, "a box of the array");
  const auto bytes = static_cast<std::size_t>(array.nbytes());
  const auto copy = std::make_shared<std::vector<std::byte>>(bytes);
  std::memcpy(copy->data(), view.samples, bytes);
  view.samples = copy->data();
  return {view, copy};
}

py::bytes BlockedArray::mesh(std::size_t block, const py::array& samples) const {
  const VolumeView view = view_of(samples, slices(block), "block " + std::to_string(block));
  ExtractOptions options = options_;
  options.space = axes_.space_in_library(options.space);
  const auto work = [view, options, plan = plan_, block](const RunControl& control) {
    return bytes_of(mesh_block(view, plan, block, options, control));
  };
  return compute_interruptibly(work, {.threads = threads_, .keep_alive = samples});
}

std::shared_ptr<Levels> BlockedArray::merge(const std::vector<py::bytes>& stored,
                                            const py::function& samples,
                                            const py::object& progress) const {
  const auto bytes = std::make_shared<std::vector<std::string>>();
  for (const py::bytes& it : stored) bytes->emplace_back(std::string_view(it));
  ExtractOptions options = options_;
  options.space = axes_.space_in_library(options.space);
  const auto work = [bytes, options, self = *this,
                     samples = py::handle(samples)](const RunControl& control) {
    std::vector<BlockMesh> meshes;
    for (std::string& it : *bytes) {
      meshes.push_back(from_bytes<BlockMesh>(it, kBlockData));
      require_corners_in_range(meshes.back().hierarchy, kBlockData);
      it = {};
    }
    const auto samples_of = [&](const BlockBox& box) {
      control.check_cancelled();
      return self.samples_in(box, samples);
    };
    return merge_blocks(self.plan_, std::move(meshes), options, control, samples_of);
  };
  Extraction extraction = compute_interruptibly(
      work, {.progress = progress, .threads = threads_, .keep_alive = samples});
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
