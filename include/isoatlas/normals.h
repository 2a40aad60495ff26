// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "isoatlas/export.h"
#include "isoatlas/field.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// Outward unit normals of the vertices of a mesh: the area-weighted mean of the normals of the
/// triangles around each. V x 3; zero where the triangles cancel out, or there are none.
/// @throws Error(bad_argument) if a corner is out of range. @cost O(V + T)
ISOATLAS_API std::vector<Vec3> vertex_normals(const MeshView& mesh);

/// The same from the gradient of the volume's interpolant at each vertex: the normals of the
/// isosurface. A vertex where the gradient is zero, or which is outside the volume, gets the normal
/// of its triangles.
/// @param space  of the mesh's coordinates
/// @throws Error(bad_argument) as above, and as extract() for the volume. @cost O(V + T), and for
/// floating-point samples with
///         NonFinite::below or above one pass over the volume
ISOATLAS_API std::vector<Vec3> vertex_normals(const MeshView& mesh, const VolumeView& volume,
                                              const SurfaceOptions& surface,
                                              Space space = Space::lps,
                                              const RunControl& control = {});

/// The same from the gradient of a field with a gradient, for a mesh in the field's world.
/// @param inside  above: outward is where the field falls
/// @throws Error(bad_argument) if the field has no gradient
ISOATLAS_API std::vector<Vec3> vertex_normals(const MeshView& mesh, const ScalarField& field,
                                              Inside inside = Inside::above);

}  // namespace isoatlas
