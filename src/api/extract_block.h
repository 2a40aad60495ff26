// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/box_faces.h"
#include "isoatlas/extract.h"

namespace isoatlas::detail {

/// Where a block is in a larger volume.
struct BlockPlace {
  SharedFaces shared{};  ///< faces of the block that are faces of other blocks, too
  const Grid& whole;     ///< of the larger volume
  Vec3 first;            ///< its sample that is the first one of the block
  Space space;           ///< positions have no self-intersections in this space
};

/// extract() for a block of a larger volume. All c-vertices on shared faces are vertices of every
/// level, and depend on the samples of these faces alone. So the meshes of all blocks together are
/// a mesh of the larger volume, embedded and with the topology of its isosurface
/// (docs/theory/08-seams.md).
/// @param options  with Space::voxel, all lengths in world units
/// @return positions in sample-index coordinates of the block; no levels if there is no surface in
///         the block
/// @throws as extract(), but not Error(empty_surface); Error(unsupported) for options that need the
///         whole surface
Extraction extract_block(const VolumeView& block, const ExtractOptions& options,
                         const BlockPlace& place, const RunControl& control = {});

}  // namespace isoatlas::detail
