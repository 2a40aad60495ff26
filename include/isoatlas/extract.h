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

struct Extraction {
  Hierarchy hierarchy;
  ExtractReport report;
  TriangleMesh mesh() const {
    return hierarchy.mesh(hierarchy.levels.size() - 1);
  }  ///< the finest level
  const LevelReport& finest() const { return report.levels.back(); }
};

/// Meshes the isosurface of a volume in nested levels: coarse, then refined; each with the topology
/// of the reference surface, checked. Constraints that cannot be met together are no error: see
/// LevelReport::constraints.
///
/// @throws Error(bad_argument)  size < 2 along an axis, spacing not positive or different by more
/// than 1e6 between axes, origin,
///                              direction or a corner of the volume not finite, fewer than 2^16
///                              doubles to a voxel there, direction singular, isovalue not finite,
///                              max_radius <= 0, event_persistence < 0, supersample 0 or so large
///                              that there are too many samples, adaptive_supersample >
///                              kMaxSubdivisions, min_component_size < 0 or not finite, a bound
///                              that its quantity cannot have
/// @throws Error(unsupported)   NaN or infinity while non_finite is `refuse` (message: count and
/// first index); a direction that is
///                              not orthonormal, unless `refine` and `coarse` are empty and nothing
///                              is to be measured
/// @throws Error(empty_surface) no sample, or every sample, is inside (message: the range); every
/// component was to be dropped
/// @throws Error(internal)      the finished mesh failed its own check: a bug; no mesh is returned
/// @throws Error(cancelled)     control.cancel was set
/// @post   same input, same bytes, for any number of threads
/// @cost   one pass over the volume, then O(C log C) for C c-vertices
/// @source Gavriliu, Carranza, Breen, Barr, IEEE Visualization 2001, sections 3.2 to 3.6, with the
/// departures in docs/theory/
ISOATLAS_API Extraction extract(const VolumeView& volume, const ExtractOptions& options,
                                const RunControl& control = {});

/// The same at an isovalue, with one refined level per goal and all else by default:
/// `extract(volume, 300.5, {within(2 * vx), within(0.4)})`.
inline Extraction extract(const VolumeView& volume, double isovalue,
                          std::vector<LevelGoal> refine = {default_goal()}) {
  ExtractOptions options;
  options.surface.isovalue = isovalue;
  options.refine = std::move(refine);
  return extract(volume, options);
}

}  // namespace isoatlas
