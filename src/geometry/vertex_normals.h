// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// Per vertex, the normalized sum of the area vectors of its triangles; zero if they cancel out
/// or the vertex has no triangles.
/// @param unit  a length of the order of the mesh's, so that areas stay in range
std::vector<Vec3> vertex_normals(const MeshView& mesh, double unit);

}  // namespace isoatlas::detail
