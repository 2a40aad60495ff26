// SPDX-License-Identifier: Apache-2.0
// Smooth surfaces of segmentations.
#pragma once

#include <cstdint>
#include <span>

#include "isoatlas/export.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// When samples of a mask that touch at an edge or a corner only are connected.
enum class MaskConnectivity : std::uint8_t {
  /// Inside samples are connected across edges, outside samples only across faces: what the
  /// isosurface of the 0/1 mask at 0.5 does, where ties join the inside.
  inside_18,
  /// Inside samples are connected only across faces, outside samples across edges.
  inside_6,
  /// Whatever the smooth field gives.
  field,
};

struct MaskFieldOptions {
  MaskConnectivity connectivity = MaskConnectivity::inside_18;
};

/// A smooth field whose zero set separates the inside samples of a mask from the others: >= 0
/// inside, < 0 outside, about the signed distance to the boundary in units of the smallest spacing,
/// constant further away. Meshed at isovalue 0 with Topology::faces, it has the components, genus
/// and boundary loops of the mask with the given connectivity.
///
/// The field has the least second differences of all that keep every sample on its side, at a
/// distance of at least 0.05 from zero. Thin parts are kept, and slices that are thick are
/// interpolated.
///
/// Based on: Lempitsky (CVPR 2010), Surface extraction from binary volumes with higher-order
/// smoothness; Nesterov's accelerated projected gradient with restarts.
///
/// @param mask  a sample is inside if it is not 0. NaN is outside
/// @throws Error(empty_surface) if all samples are inside or all are outside; Error(bad_argument)
///         for a volume with fewer than two samples along an axis; Error(cancelled)
/// @return float32 samples, on the grid of the mask
/// @cost   O(N) for the samples and about 7 microseconds per sample next to the boundary; 5 bytes
///         per sample and about 0.6 KB per sample next to the boundary. Parallel; the same bytes
///         for any number of threads
ISOATLAS_API Volume mask_field(const VolumeView& mask, const MaskFieldOptions& options = {},
                               const RunControl& control = {});

/// The mask of some labels of a label map: 1 where a sample equals one of them.
/// @throws Error(unsupported) if the samples are floating-point numbers and one of them is not
///         whole; Error(empty_surface) if no sample has one of the labels
/// @return uint8 samples. O(N)
ISOATLAS_API Volume mask_of_labels(const VolumeView& labels, std::span<const std::int64_t> wanted);

}  // namespace isoatlas
