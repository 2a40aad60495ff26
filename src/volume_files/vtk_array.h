// SPDX-License-Identifier: Apache-2.0
// Code for VTK's legacy and XML files: named arrays of values at the points or in the cells of a
// grid.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "files/vtk_values.h"
#include "isoatlas/volume_file.h"

namespace isoatlas::detail::io {

struct VtkArray {
  std::string name = {};
  bool is_cell_data = false;  ///< one tuple per cell of the grid, otherwise per point
  bool is_marked = false;     ///< the file marks it as the scalars
  VtkType type = {};
  std::uint64_t components = 1;
  std::vector<std::string> component_names = {};  ///< empty if the components have no names
};

/// True for an array that is not a volume but marks samples as copies or hidden.
bool is_ghost_array(const std::string& name);

/// The index of the array to read: the array that `options.array` names, else the only marked
/// array, else the only array. Point data precedes cell data. If the file has both, arrays of cells
/// are called "cell:NAME".
/// @throws ChoiceNeeded like take_choice()
std::size_t choose_array(const std::filesystem::path& path, const std::vector<VtkArray>& arrays,
                         const ReadOptions& options, VolumeSource& source);

/// The component to read; if there are several, `options.channel` must name one.
std::uint64_t choose_component(const std::filesystem::path& path, const VtkArray& array,
                               const ReadOptions& options, VolumeSource& source);

/// A grid of points with equal steps.
struct VtkGrid {
  std::array<std::size_t, 3> points{};
  Vec3 spacing{1, 1, 1};
  Vec3 origin{};  ///< world position of point 0
  std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  std::array<std::int64_t, 3> first{};  ///< number of the first point along each axis

  std::array<std::size_t, 3> cells() const;
};

/// The grid of the samples: the points, or the centres of the cells, which is noted in `source`.
/// @throws Error like checked_sample_bytes() and grid_of_file()
Grid sample_grid(const std::filesystem::path& path, const VtkGrid& grid, bool is_cell_data,
                 VolumeSource& source);

struct AxisCoordinates {
  std::vector<double> values = {};
  double rounding = 0;  ///< relative rounding of a value: that of float, or of six digits
};

AxisCoordinates coordinates_of_axis(VtkValues& values, VtkType type, std::uint64_t count,
                                    bool is_text);

/// Coordinates with equal steps.
struct EvenSteps {
  double first = 0;
  double step = 1;
};

/// @throws Error(unsupported)  if the steps differ by more than rounding, or by 0.001 of a step
EvenSteps even_steps(const std::filesystem::path& path, const AxisCoordinates& coordinates,
                     char axis_name);

}  // namespace isoatlas::detail::io
