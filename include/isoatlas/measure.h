// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// Against which isosurface a mesh is measured, and how densely.
struct MeasureOptions {
  double isovalue = 0;
  Inside inside = Inside::above;
  NonFinite non_finite = NonFinite::refuse;
  Space space = Space::lps;       ///< of the mesh's coordinates
  std::size_t samples = 200'000;  ///< wanted in each direction; vertices, edge midpoints and centroids come on top
};

/// Distances from samples of one surface to the closest point of the other, world units.
struct OneSidedDistance {
  std::size_t samples = 0;
  double samples_per_voxel_face = 0;  ///< density: samples per area of (smallest spacing)^2
  double maximum = 0, mean = 0, root_mean_square = 0, p50 = 0, p99 = 0;
  Vec3 farthest{};  ///< the sample at which the maximum is, in the mesh's space
};

/// How far a mesh is from the trilinear isosurface of a volume.
struct Measurement {
  double voxel = 1;  ///< the smallest spacing: divide lengths by it to have voxels
  OneSidedDistance mesh_to_surface, surface_to_mesh;
  double maximum() const;  ///< of both directions
  double p99() const;      ///< the larger of both directions
  double mean() const;     ///< the larger of both directions
  /// Angle between a triangle's normal and the isosurface's normal at the closest point, over the mesh's samples, degrees.
  double normal_mean = 0, normal_p99 = 0, normal_maximum = 0;
  double surface_area = 0, mesh_area = 0;  ///< world units squared; of the isosurface as sampled
};

/// Two-sided distance between a triangle mesh (any mesh, not only ours) and the trilinear isosurface, sampled.
///
/// Where the isosurface leaves the volume it ends, so the distance near an open boundary is to its edge.
/// Deterministic: the samples are stratified by area and placed by a fixed low-discrepancy sequence.
/// @throws as extract(), and Error(bad_argument) if the mesh has no triangles or a corner out of range
/// @cost O((samples + triangles + c-vertices) log)
Measurement measure(const TriangleMesh& mesh, const VolumeView& volume, const MeasureOptions& options, const RunControl& control = {});

}  // namespace isoatlas
