// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <optional>
#include <string>

#include "array_volume.h"
#include "levels.h"

namespace isoatlas::detail::python {

/// The JSON that `isoatlas check --json` prints for a mesh.
/// @param vertices  V x 3
/// @param faces     F x 3, corners < V
/// @param volume    if missing, no distance is measured
/// @param measure   options of the measurement, named as on the command line, without dashes
/// @throws Error like mesh_topology(), find_self_intersections() and measure()
std::string check_mesh(const py::array_t<double, py::array::c_style>& vertices,
                       const py::array_t<std::uint32_t, py::array::c_style>& faces,
                       bool self_intersections, const std::optional<ArrayVolume>& volume,
                       const Words& measure, int threads, const py::object& progress);

}  // namespace isoatlas::detail::python
