// SPDX-License-Identifier: Apache-2.0
// A volume made to break the mesher, meshed as a user would: default options, coarse, then to one
// voxel, then to half a voxel.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "support/reference_topology.h"
#include "support/soundness.h"
#include "support/surfaces.h"

namespace isoatlas::detail::test {

/// ISOATLAS_ADVERSARIAL=many in the environment: all there is, in minutes.
inline bool many() {
  const char* const wanted = std::getenv("ISOATLAS_ADVERSARIAL");
  return wanted != nullptr && std::string(wanted) == "many";
}

inline ExtractOptions default_levels(const VolumeView& volume, double isovalue,
                                     Inside inside = Inside::above) {
  ExtractOptions options = coarse_options();
  options.surface.isovalue = isovalue;
  options.surface.inside = inside;
  const double voxel = volume.grid.smallest_spacing();
  options.refine = {{{Quantity::max_distance, voxel}}, {{Quantity::max_distance, 0.5 * voxel}}};
  return options;
}

inline Extraction expect_sound(const VolumeView& volume, const ExtractOptions& options,
                               const std::string& what) {
  Extraction e = extract(volume, options);
  EXPECT_EQ(what_is_wrong(e, options), "") << what;
  return e;
}

/// With a second opinion: of the loops on the faces of cells, and of tunnels there may only be as
/// many as the Euler characteristic says.
inline void expect_sound(const Samples& samples, const std::string& what, double isovalue = 0,
                         Inside inside = Inside::above, Vec3 spacing = {1, 1, 1}) {
  if (!has_surface(samples, isovalue, inside)) return;
  const Volume volume = to_volume(samples, SampleType::int32, spacing);
  const Extraction e = expect_sound(volume, default_levels(volume, isovalue, inside), what);
  const TopologySummary faces = reference_topology(samples, isovalue, inside);
  EXPECT_EQ(e.report.reference.euler_characteristic,
            faces.euler_characteristic - 2 * static_cast<std::int64_t>(e.report.tunnels))
      << what;
  EXPECT_EQ(e.report.reference.boundary_loops, faces.boundary_loops) << what;
  if (e.report.tunnels == 0) {
    EXPECT_EQ(e.report.reference, faces) << what;
  }
}

}  // namespace isoatlas::detail::test
