// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "isoatlas/export.h"
#include "isoatlas/hierarchy.h"
#include "isoatlas/options.h"
#include "isoatlas/report.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// The result of extract(): the meshes of all levels and the report about them.
struct Extraction {
  Hierarchy hierarchy;
  ExtractReport report;  ///< `report.levels` has one entry per level of `hierarchy`
  /// A copy of the finest level.
  TriangleMesh mesh() const {
    return hierarchy.mesh(hierarchy.levels.empty() ? 0 : hierarchy.levels.size() - 1);
  }
  /// The report about the finest level.
  const LevelReport& finest() const { return report.levels.back(); }
};

/// Meshes the isosurface of a volume in nested levels of detail: a coarse level, then one refined
/// level per entry of ExtractOptions::refine. Every level has the topology of the reference
/// surface; this is proved by a certificate and recounted on the output triangles. If some
/// constraints cannot be satisfied, extract() still succeeds, and LevelReport::constraints states
/// the reason.
///
/// @param volume  at least two samples along each axis, N samples in all
/// @param options  constraints and placement of the levels, output space, and the choice of surface
/// @param control  progress, cancellation and number of threads
/// @throws Error(bad_argument)
///   - volume: fewer than two samples along an axis; a spacing that is not positive, or spacings
///     that differ by a factor of more than 1e6; origin, direction or a corner of the volume not
///     finite; a singular direction; an origin so far away that a voxel spans fewer than 2^16
///     doubles;
///   - options: isovalue not finite; `covering.max_radius` <= 0; `covering.event_persistence` < 0;
///     `supersample` 0 or too large for the number of samples; `adaptive_supersample` above
///     kMaxSubdivisions; `components.min_size` < 0 or not finite; a bound outside the domain of its
///     quantity; `border` closed together with `allow_self_intersections`
/// @throws Error(unsupported)
///   - a sample is NaN or infinite and `surface.non_finite` is `refuse` (the message gives the
///     count and the first index);
///   - with a closed `border`: the whole volume boundary is inside and `components` selects some
///     components, or the mesh cannot be closed because self-intersections remain;
///   - the direction is not orthonormal, except if `refine` and `coarse` are empty and
///     `measure_samples` is 0
/// @throws Error(empty_surface)  no sample or every sample is inside (the message gives the range
///   of the samples), or `components` drops every component
/// @throws Error(internal)  the finished mesh failed its check: a bug; no mesh is returned
/// @throws Error(out_of_memory)  an allocation failed
/// @throws Error(cancelled)  `control.cancel` was set
/// @post   the same input gives the same bytes for any number of threads
/// @cost   one pass over the volume, then O(C log C) for C c-vertices
/// @source Gavriliu, Carranza, Breen, Barr, IEEE Visualization 2001, sections 3.2 to 3.6; the
///   deviations are listed in docs/theory/
ISOATLAS_API Extraction extract(const VolumeView& volume, const ExtractOptions& options,
                                const RunControl& control = {});

/// extract() at an isovalue, with one refined level per goal and default options otherwise. Example
/// with two refined levels: `extract(volume, 300.5, {within(2 * vx), within(0.4)})`.
inline Extraction extract(const VolumeView& volume, double isovalue,
                          std::vector<LevelGoal> refine = {default_goal()}) {
  ExtractOptions options;
  options.surface.isovalue = isovalue;
  options.refine = std::move(refine);
  return extract(volume, options);
}

}  // namespace isoatlas
