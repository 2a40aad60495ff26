// SPDX-License-Identifier: Apache-2.0
// Whether a mesh is where its volume is.
#pragma once

#include <string>

#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail::tool {

/// Empty if the mesh, with coordinates in `space`, is where the volume is: their bounding boxes
/// overlap and no distance is larger than the volume. Otherwise one line with both boxes and the
/// --space in which they overlap, if there is one.
std::string misplacement(const TriangleMesh& mesh, const Grid& grid, Space space,
                         const Measurement& measured);

}  // namespace isoatlas::detail::tool
