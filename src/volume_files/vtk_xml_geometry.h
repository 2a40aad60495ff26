// SPDX-License-Identifier: Apache-2.0
// The geometry of a VTK XML image or rectilinear grid.
#pragma once

#include "isoatlas/volume_file.h"
#include "volume_files/vtk_array.h"
#include "volume_files/vtk_xml_grid.h"

namespace isoatlas::detail::io {

/// Also sets `source.has_spacing`.
/// @throws Error(bad_file)     if coordinates are missing or damaged, or a piece is not where the
/// header places it
/// @throws Error(unsupported)  if the steps are not equal
VtkGrid vtk_xml_geometry(const VtkXmlGrid& grid, const ReadOptions& options, VolumeSource& source);

}  // namespace isoatlas::detail::io
