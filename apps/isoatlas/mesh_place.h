// SPDX-License-Identifier: Apache-2.0
// Is a mesh where the volume is that it is measured against?
#pragma once

#include <string>

#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail::tool {

/// Empty if the mesh, its coordinates taken to be in `space`, is in the volume's place: their boxes
/// overlap and no distance is larger than the volume. Else one line with both boxes, naming the
/// --space in which they overlap if there is one.
std::string misplacement(const TriangleMesh& mesh, const Grid& grid, Space space,
                         const Measurement& measured);

}  // namespace isoatlas::detail::tool
