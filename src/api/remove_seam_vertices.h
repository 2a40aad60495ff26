// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "isoatlas/blocks.h"

namespace isoatlas::detail {

/// Removes vertices at seams from the merged mesh of all blocks, where the goal of a level permits
/// it. Levels remain nested: a level keeps the vertices of coarser ones.
///
/// Level by level, from coarse to fine. The distance from the isosurface is tested with the samples
/// around one shared face at a time. Levels with bounds on other metrics remain as they are.
///
/// @param hierarchy   of the whole volume, in sample-index coordinates
/// @param is_on_seam  per vertex, 1 if it is on a shared face
/// @param options     with lengths in world units
/// @return the number of vertices that no level has any more
std::size_t remove_seam_vertices(Hierarchy& hierarchy, std::span<const std::uint8_t> is_on_seam,
                                 const BlockPlan& plan, const ExtractOptions& options,
                                 const SamplesOfBlock& samples_of, const RunControl& control);

}  // namespace isoatlas::detail
