// SPDX-License-Identifier: Apache-2.0
#include "array_volume.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "isoatlas/error.h"

namespace isoatlas::detail::python {
namespace {

Vec3 vec(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

/// The axes of the array, sorted from the smallest stride to the largest.
/// @throws std::invalid_argument unless the samples fill their memory without gaps in that order
std::array<int, 3> axes_in_memory(const py::array& array) {
  // An axis with one sample can have any stride. Axes with equal strides keep C order.
  std::array<int, 3> axes{2, 1, 0};
  std::ranges::stable_sort(axes, {}, [&](int axis) { return array.strides(axis); });
  py::ssize_t expected = array.itemsize();
  for (const int axis : axes) {
    if (array.size() > 0 && array.shape(axis) > 1 && array.strides(axis) != expected)
      throw std::invalid_argument("the array is not dense");
    expected *= array.shape(axis);
  }
  return axes;
}

}  // namespace

SampleType sample_type_of(const py::dtype& type) {
  for (int i = 0; i <= static_cast<int>(SampleType::float64); ++i) {
    const auto sample_type = static_cast<SampleType>(i);
    if (type.equal(py::dtype(std::string(name(sample_type))))) return sample_type;
  }
  throw std::invalid_argument("the array's dtype is not a sample type");
}

VolumeView ArrayVolume::view() const {
  return {axes.to_library(grid), sample_type_of(array.dtype()), array.data()};
}

ArrayVolume array_volume(const py::array& array, const std::string& order,
                         const std::array<double, 3>& spacing, const std::array<double, 3>& origin,
                         const std::array<std::array<double, 3>, 3>& direction,
                         const std::string& path, LengthUnit unit, VolumeSource source) {
  if (order != "ijk" && order != "xyz")
    throw Error(ErrorCode::bad_argument, "order: expected one of ijk, xyz, got '" + order + "'");
  if (array.ndim() != 3) throw std::invalid_argument("the array is not 3-D");
  const auto coordinate = [&](int axis) { return order == "ijk" ? axis : 2 - axis; };

  std::array<int, 3> of{};
  std::ranges::transform(axes_in_memory(array), of.begin(), coordinate);
  Grid grid;
  for (int axis = 0; axis < 3; ++axis)
    grid.size[coordinate(axis)] = static_cast<std::size_t>(array.shape(axis));
  grid.spacing = vec(spacing);
  grid.origin = vec(origin);
  grid.unit = unit;
  for (std::size_t k = 0; k < 3; ++k)
    grid.direction[k] = {direction[0][k], direction[1][k], direction[2][k]};
  return {array, path, grid, Axes(of), order == "xyz", std::move(source)};
}

}  // namespace isoatlas::detail::python
