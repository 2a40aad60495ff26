// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <string>
#include <vector>

#include "axes.h"
#include "isoatlas/volume.h"
#include "isoatlas/volume_source.h"

namespace isoatlas::detail::python {

namespace py = pybind11;

/// A numpy array with the geometry that makes it a volume. The samples are not copied.
struct ArrayVolume {
  py::array array;
  std::string path;  ///< the file that the array was read from; empty: not read from a file
  Grid grid;         ///< in the caller's coordinates
  Axes axes;
  bool is_xyz = false;  ///< the caller's coordinates are x, y, z, as in a file
  VolumeSource source;  ///< how the file was understood

  VolumeView view() const;  ///< in the library's coordinates
};

/// @param array      3-D, one of the sample types, native byte order, aligned, and dense: for some
///                   order of its axes it is C-contiguous
/// @param order      "ijk": the coordinates are in the order of the array's axes; "xyz": in the
///                   opposite order
/// @param spacing    in the order of the coordinates, like all following parameters
/// @param direction  3 x 3, row by row; column k is the unit vector of the axis of coordinate k
/// @throws Error(bad_argument) if `order` has another value; std::invalid_argument if the array is
///         not 3-D or not dense
ArrayVolume array_volume(const py::array& array, const std::string& order,
                         const std::array<double, 3>& spacing, const std::array<double, 3>& origin,
                         const std::array<std::array<double, 3>, 3>& direction,
                         const std::string& path, LengthUnit unit, VolumeSource source);

/// The sample type with this dtype.
/// @throws std::invalid_argument if there is no such sample type
SampleType sample_type_of(const py::dtype& type);

}  // namespace isoatlas::detail::python
