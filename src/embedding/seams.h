// SPDX-License-Identifier: Apache-2.0
// A seam is the boundary that the meshes of two blocks have in common: the boundary edges on a face
// that the blocks share.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "complex/surface_complex.h"
#include "geometry/box_faces.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// Finds where a mesh touches a shared face in more than its vertices and its seam there, which the
/// mesh of the other block could do as well. Because blocks are convex, meshes for which the result
/// is empty only share their seams.
/// @param positions  in sample-index coordinates
/// @param sites      per vertex, its c-vertex on the surface; all on shared faces are sites
/// @return vertices at which the mesh must be finer, sorted
/// @cost  O(V + T), and O(B log B) for B vertices on the volume boundary
std::vector<std::uint32_t> vertices_that_prevent_seams(std::span<const Vec3> positions,
                                                       std::span<const Triangle> triangles,
                                                       std::span<const CVertexId> sites,
                                                       const SurfaceComplex& surface,
                                                       const SharedBox& shared);

}  // namespace isoatlas::detail
