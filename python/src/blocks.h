// SPDX-License-Identifier: Apache-2.0
// Volumes that are meshed block by block, for isoatlas.dask.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "axes.h"
#include "isoatlas/blocks.h"
#include "levels.h"

namespace isoatlas::detail::python {

namespace py = pybind11;

/// Per axis of an array, the first sample of a box and the one after its last.
using Slices = std::array<std::pair<std::size_t, std::size_t>, 3>;

/// A 3-D array whose samples are elsewhere, and how it is meshed. Its blocks are C-contiguous
/// arrays. All sizes and indices are in the order of the array's axes.
class BlockedArray {
 public:
  /// @param shape, dtype  of the whole array
  /// @param blocks        grid cells of a block along each axis
  /// @param order, spacing, origin, direction, unit  as for array_volume()
  BlockedArray(const std::array<std::size_t, 3>& shape, const py::dtype& dtype,
               const std::array<std::size_t, 3>& blocks, const std::string& order,
               const std::array<double, 3>& spacing, const std::array<double, 3>& origin,
               const std::array<std::array<double, 3>, 3>& direction, const std::string& unit,
               const ExtractWords& words);

  std::size_t count() const { return plan_.block_count(); }
  Slices slices(std::size_t block) const;
  /// The mesh of a block as bytes that merge() takes.
  py::bytes mesh(std::size_t block, const py::array& samples) const;
  /// The levels of the whole array. `meshes` are those of all blocks, in any order.
  /// @param samples  function of three pairs (first, end): the samples of that box, C-contiguous
  std::shared_ptr<Levels> merge(const std::vector<py::bytes>& meshes, const py::function& samples,
                                const py::object& progress) const;

 private:
  VolumeView view_of(const py::array& samples, const Slices& slices, const std::string& name) const;
  Volume samples_in(const BlockBox& box, py::handle samples) const;

  Grid grid_;  // in the caller's coordinates
  Axes axes_;
  bool is_xyz_;
  SampleType type_;
  int threads_;
  ExtractOptions options_;  // lengths in world units
  BlockPlan plan_;          // in the library's coordinates
};

}  // namespace isoatlas::detail::python
