// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "isoatlas/export.h"
#include "isoatlas/field.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// Outward unit normals at the vertices of a mesh: the area-weighted mean of the normals of the
/// adjacent triangles.
/// @return V x 3; zero for a vertex without triangles, or if the normals of its triangles cancel
/// @throws Error(bad_argument) if a corner is out of range
/// @cost   O(V + T)
ISOATLAS_API std::vector<Vec3> vertex_normals(const MeshView& mesh);

/// Outward unit normals of the isosurface at the vertices of a mesh, from the gradient of the
/// volume's interpolant. Where the gradient is zero, and outside the volume, a vertex gets the
/// normal of the mesh.
/// @param space  the space of the mesh's coordinates
/// @return V x 3, in the space of the mesh
/// @throws Error(bad_argument) if a corner is out of range
/// @throws Error as extract(), for the volume and the isovalue
/// @cost   O(V + T), and one pass over the volume if samples are floating-point and
///         `surface.non_finite` is `below` or `above`
ISOATLAS_API std::vector<Vec3> vertex_normals(const MeshView& mesh, const VolumeView& volume,
                                              const SurfaceOptions& surface,
                                              Space space = Space::lps,
                                              const RunControl& control = {});

/// Outward unit normals at the vertices of a mesh, from the gradient of a field. Where the gradient
/// is zero, a vertex gets the normal of the mesh.
/// @param mesh   positions in the world coordinates of the field
/// @param inside  with `above`, the normal points to smaller values of the field
/// @return V x 3
/// @throws Error(bad_argument) if the field has no gradient, or a corner is out of range
/// @cost   O(V + T), and one call of the gradient per vertex
ISOATLAS_API std::vector<Vec3> vertex_normals(const MeshView& mesh, const ScalarField& field,
                                              Inside inside = Inside::above);

}  // namespace isoatlas
