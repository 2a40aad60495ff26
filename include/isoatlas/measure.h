// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "isoatlas/export.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// Against which isosurface a mesh is measured, and how densely.
struct MeasureOptions {
  SurfaceOptions surface{};
  Space space = Space::lps;       ///< of the mesh's coordinates
  std::size_t samples = 200'000;  ///< spread over the area of each surface; those at vertices and
                                  ///< the like come on top
};

/// Distances from samples of one surface to the closest point of the other, world units.
struct OneSidedDistance {
  /// All of them. Of a mesh: those spread over its area, then vertices, edge midpoints and
  /// centroids of the triangles; of the isosurface: those spread over its area, then c-vertices.
  /// Maxima are over all, the other numbers over those spread by area.
  std::size_t samples = 0;
  double samples_per_voxel_face =
      0;  ///< density of those spread by area: samples per (smallest spacing)^2
  double maximum = 0, mean = 0, root_mean_square = 0, p50 = 0, p99 = 0;
  Vec3 farthest{};  ///< the sample at which the maximum is, in the mesh's space
};

/// How far a mesh is from the isosurface of a volume.
struct ISOATLAS_API Measurement {
  double voxel = 1;  ///< the smallest spacing: divide lengths by it to have voxels
  OneSidedDistance mesh_to_surface, surface_to_mesh;
  double maximum() const;  ///< of both directions
  double p99() const;      ///< the larger of both directions
  double mean() const;     ///< the larger of both directions
  /// Angle between a triangle's normal and the isosurface's outward normal at the closest point,
  /// degrees; over the mesh's samples inside triangles. Above 90 degrees a triangle is turned over.
  /// 0 if no triangle has a normal.
  double normal_mean = 0, normal_p99 = 0, normal_maximum = 0;
  double surface_area = 0,
         mesh_area =
             0;  ///< world units squared; of the isosurface: that of the faces it is sampled by
};

/// Two-sided distance between a triangle mesh (any mesh, not only ours) and the isosurface,
/// sampled.
///
/// Where the isosurface leaves the volume it ends, so the distance near an open boundary is to its
/// edge. Lengths are those of the volume's spacing, whatever the mesh's space. Maxima are over
/// samples, so they are estimates from below; each distance to the isosurface is one from above,
/// tight but for noise, where within a third of a voxel the nearest of several sheets may be
/// missed.
///
/// Samples are stratified by area and placed by a fixed low-discrepancy sequence: same input, same
/// numbers, for any number of threads.
/// @throws as extract(), which refuses to refine on a sheared grid, and Error(bad_argument) if the
/// mesh has no triangles, a corner out of range, or a vertex that is not
///         finite or more than 1e15 voxels away; if no samples are wanted
/// @cost   one pass over the volume, then O((samples + triangles + c-vertices) log)
ISOATLAS_API Measurement measure(const MeshView& mesh, const VolumeView& volume,
                                 const MeasureOptions& options, const RunControl& control = {});

}  // namespace isoatlas
