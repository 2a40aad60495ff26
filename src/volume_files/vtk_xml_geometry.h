// SPDX-License-Identifier: Apache-2.0
// Where the points of a VTK XML image or rectilinear grid are.
#pragma once

#include "isoatlas/volume_file.h"
#include "volume_files/vtk_array.h"
#include "volume_files/vtk_xml_grid.h"

namespace isoatlas::detail::io {

/// Sets `source.has_spacing`.
/// @throws Error(bad_file)     missing or damaged coordinates, or a piece that is elsewhere than
/// the header says
/// @throws Error(unsupported)  steps that are not equal
VtkGrid vtk_xml_geometry(const VtkXmlGrid& grid, const ReadOptions& options, VolumeSource& source);

}  // namespace isoatlas::detail::io
