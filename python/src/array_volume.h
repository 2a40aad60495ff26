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

/// A numpy array as a volume, and where its samples are said to be. Nothing is copied.
struct ArrayVolume {
  py::array array;
  std::string path;  ///< of the file it was read from; empty if there is none
  Grid grid;         ///< in the caller's coordinates
  Axes axes;
  bool is_xyz = false;  ///< the coordinates are x, y, z, as in a file
  VolumeSource source;  ///< how that file was understood

  VolumeView view() const;  ///< in the library's
};

/// @param array      3-D, of one of the sample types, native byte order, aligned, dense: some order
/// of its axes makes it C-contiguous
/// @param order      "ijk": coordinates run along the axes of the array, in their order; "xyz": in
/// the opposite order
/// @param spacing    in the order of the coordinates, as all that follows
/// @param direction  3 x 3, rows first; column k is the unit vector of coordinate k's axis
/// @throws Error(bad_argument) if the order is another
ArrayVolume array_volume(const py::array& array, const std::string& order,
                         const std::array<double, 3>& spacing, const std::array<double, 3>& origin,
                         const std::array<std::array<double, 3>, 3>& direction,
                         const std::string& path, LengthUnit unit, VolumeSource source);

/// Throws std::invalid_argument if it is none.
SampleType sample_type_of(const py::dtype& type);

}  // namespace isoatlas::detail::python
