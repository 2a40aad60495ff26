// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// Per vertex the direction of the sum of the area vectors of its triangles, of length 1; zero where all cancels out or there is none.
/// @param unit  a length like the mesh's, so that areas leave no range
std::vector<Vec3> vertex_normals(const MeshView& mesh, double unit);

}  // namespace isoatlas::detail
