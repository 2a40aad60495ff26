// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "isoatlas/export.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// The isosurface that a mesh is compared with, and the number of samples.
struct MeasureOptions {
  SurfaceOptions surface{};
  Space space = Space::lps;  ///< the space of the mesh's coordinates
  /// Number of samples spread by area over the mesh, and over the isosurface; at least 1. Vertices,
  /// edge midpoints, centroids and c-vertices are sampled in addition.
  std::size_t samples = 200'000;
};

/// Statistics of the distances from samples of one surface to the closest point of the other one,
/// in world units. The maximum is taken over all samples, the other values over those spread by
/// area.
struct OneSidedDistance {
  /// Number of all samples. On a mesh: samples spread by area, vertices, edge midpoints and
  /// centroids of triangles. On the isosurface: samples spread by area, and c-vertices.
  std::size_t samples = 0;
  /// Density of the samples spread by area: samples per square of the smallest spacing.
  double samples_per_voxel_face = 0;
  double maximum = 0, mean = 0, root_mean_square = 0, p50 = 0, p99 = 0;
  Vec3 farthest{};  ///< position of the sample with the largest distance, in the mesh's space
};

/// The two-sided distance between a mesh and the isosurface of a volume. Lengths are in world
/// units, for every space of the mesh.
struct ISOATLAS_API Measurement {
  double voxel = 1;  ///< the smallest spacing; a length / `voxel` is the length in voxels
  OneSidedDistance mesh_to_surface, surface_to_mesh;
  double maximum() const;  ///< the larger maximum of both directions
  double p99() const;      ///< the larger 99th percentile of both directions
  double mean() const;     ///< the larger mean of both directions
  /// Angle in degrees between the normal of a triangle and the outward normal of the isosurface at
  /// the closest point, over the mesh's samples inside triangles. Above 90 degrees, the triangle
  /// faces the wrong way. 0 if no triangle has a normal.
  double normal_mean = 0, normal_p99 = 0, normal_maximum = 0;
  double surface_area =
      0;                 ///< area of the faces that represent the isosurface, world units squared
  double mesh_area = 0;  ///< area of the mesh, world units squared
};

/// Samples the two-sided distance between a triangle mesh and the isosurface of a volume. The mesh
/// can come from any program.
///
/// The isosurface ends at the volume boundary, so near an open boundary the distance is that to its
/// edge. Reported maxima are lower bounds, because only samples are measured. The distance of each
/// sample to the isosurface is an upper bound; it is tight except in noise, where a closer sheet of
/// the surface within a third of a voxel may be missed. Samples are stratified by area and follow a
/// fixed low-discrepancy sequence.
/// @param mesh  at least one triangle; coordinates in `options.space`
/// @throws Error as extract() with refined levels, for the volume and `options.surface`
/// @throws Error(bad_argument) if the mesh has no triangles, a corner out of range, or a vertex
/// that
///         is not finite or more than 1e15 voxels away; or if `options.samples` is 0
/// @post   the same input gives the same values for any number of threads
/// @cost   one pass over the volume, then O(n log n) for n samples, triangles and c-vertices
ISOATLAS_API Measurement measure(const MeshView& mesh, const VolumeView& volume,
                                 const MeasureOptions& options, const RunControl& control = {});

}  // namespace isoatlas
