// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isoatlas/mesh.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail::page {

/// Marching cubes (Lorensen and Cline, 1987) as VTK's filters make it: the same triangles, with
/// vertices shared between grid cells. A sample at the isovalue is inside. Positions are the sample
/// index times the spacing; they are not finite next to samples that are not finite.
/// @param volume  dense
/// @cost O(N) for N samples; memory for the mesh and for five layers of 4-byte integers
TriangleMesh marching_cubes_mesh(const VolumeView& volume, double isovalue);

}  // namespace isoatlas::detail::page
