// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "isoatlas/measure.h"
#include "isosurface/isosurface.h"

namespace isoatlas::detail {

/// measure() for callers that have the isosurface already. The mesh is in sample-index coordinates
/// and its triangles are oriented as the surface is there; `farthest` is in these coordinates, too,
/// and lengths are in the isosurface's metric.
/// @param samples  >= 1
/// @throws Error(bad_argument) as measure() does for meshes, Error(cancelled)
Measurement measure(const MeshView& mesh, const Isosurface& surface, std::size_t samples,
                    const RunControl& control = {});

/// The samples of a measurement whose distance is larger than a bound.
struct DistantSamples {
  double bound = 0;
  std::vector<Triangle> corners;  ///< per sample, the corners of the triangle there; on an edge or
                                  ///< a vertex some corners are repeated
};

/// The same, and lists the samples with a distance larger than `distant.bound`.
Measurement measure(const MeshView& mesh, const Isosurface& surface, std::size_t samples,
                    DistantSamples& distant, const RunControl& control);

/// Converts from voxels (smallest spacings) and sample-index coordinates to world lengths and the
/// mesh's space.
void transform_to(Measurement& measurement, const Grid& grid, Space space);

}  // namespace isoatlas::detail
