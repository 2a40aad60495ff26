// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "isoatlas/measure.h"
#include "measure/isosurface.h"

namespace isoatlas {

/// measure() for who has the isosurface already, with the mesh in sample-index coordinates: its triangles face as the surface does
/// there, `farthest` is there too, and lengths are in the isosurface's metric.
/// @param samples  >= 1
/// @throws Error(bad_argument) as measure() does for meshes, Error(cancelled)
Measurement measure(const TriangleMesh& mesh, const Isosurface& surface, std::size_t samples, const RunControl& control = {});

/// Where a measurement finds too large distances.
struct FarPlaces {
  double bound = 0;               ///< what is larger is too large
  std::vector<Triangle> corners;  ///< of the triangle at each such sample, in no order; of samples on edges and vertices some twice
};

/// The same, which also tells where distances are larger than `far.bound`.
Measurement measure(const TriangleMesh& mesh, const Isosurface& surface, std::size_t samples, FarPlaces& far, const RunControl& control);

/// From voxels (smallest spacings) and sample-index coordinates to world lengths and the mesh's space.
void transform_to(Measurement& measurement, const Grid& grid, Space space);

}  // namespace isoatlas
