// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "error/error_field.h"

namespace isoatlas::detail {

/// Moves the vertices of some cells along the surface's normals at their anchors so that errors
/// have both signs: least squares over the distances of c-vertices from the planes of their closest
/// triangles, by damped Jacobi sweeps. Vertices on the boundary, and vertices with a neighbour
/// outside `cells`, are not moved.
///
/// @param placement  its normal offsets are the start and the result; anchors do not change
void balance(const MeasuredSurface& surface, std::span<const CellId> cells, LevelMesh& mesh,
             VertexPlacement& placement);

}  // namespace isoatlas::detail
