// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "isoatlas/mesh.h"

namespace isoatlas::detail::drawing {

/// A mesh with a normal per vertex. At a sharp edge a vertex occurs several times, once per side.
struct ShadedMesh {
  TriangleMesh mesh;          ///< as many triangles as the original mesh, in its order
  std::vector<Vec3> normals;  ///< per vertex, a unit vector; zero if it is undefined
};

/// Splits a mesh along its sharp edges: those whose triangles differ in their normals by more than
/// an angle, and those without exactly two triangles of the same orientation. The normal of a
/// vertex is the mean of the normals of its triangles on the same side of all sharp edges, weighted
/// by their angles at the vertex: a long triangle counts no more than a short one.
/// @cost O(T log T)
ShadedMesh split_at_sharp_edges(const MeshView& mesh, double degrees);

}  // namespace isoatlas::detail::drawing
