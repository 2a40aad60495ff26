// SPDX-License-Identifier: Apache-2.0
// Meshes a difficult volume with default options: coarse, to one voxel, and to half a voxel; and
// checks all levels.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "support/reference_topology.h"
#include "support/soundness.h"
#include "support/surfaces.h"

namespace isoatlas::detail::test {

inline std::string wanted_patterns() {
  const char* const value = std::getenv("ISOATLAS_ADVERSARIAL");
  return value != nullptr ? value : "";
}
/// ISOATLAS_ADVERSARIAL=night, as scripts/nightly.sh sets it: all patterns.
inline bool is_night() { return wanted_patterns() == "night"; }
/// ISOATLAS_ADVERSARIAL=many, or at night: many patterns, which take minutes.
inline bool many() { return is_night() || wanted_patterns() == "many"; }

inline ExtractOptions default_levels(const VolumeView& volume, double isovalue,
                                     Inside inside = Inside::above) {
  ExtractOptions options = coarse_options();
  options.surface.isovalue = isovalue;
  options.surface.inside = inside;
  const double voxel = volume.grid.smallest_spacing();
  options.refine = {{{Quantity::max_distance, voxel}}, {{Quantity::max_distance, 0.5 * voxel}}};
  return options;
}

/// Extracts and expects that what_is_wrong() finds no error.
inline Extraction expect_sound(const VolumeView& volume, const ExtractOptions& options,
                               const std::string& what) {
  Extraction e = extract(volume, options);
  EXPECT_EQ(what_is_wrong(e, options), "") << what;
  return e;
}

/// Also compares the topology with an independent count of the loops on the faces of grid cells. It
/// may differ only by the tunnels, as the Euler characteristic requires.
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
