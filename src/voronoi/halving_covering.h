// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "voronoi/covering.h"

namespace isoatlas::detail {

/// Disks, each the c-vertices nearer to its site than its radius.
struct DiskCovering {
  std::vector<CVertexId> sites;  ///< in the order in which the disks were placed
  std::vector<float> radii;      ///< per site, R_g / 2^i
};

/// The paper's own stage one: bins, forbidden c-vertices, radii that are halved one by one.
///
/// Every c-vertex is in a disk; no site is in another's disk; radii of disks that have a c-vertex in common differ by at most a
/// factor of two; no disk has a topological event. To be compared with Covering::cover(), which it can seed.
/// @source paper, section 3.3, figures 3 to 7; where they leave a choice: docs/theory/04-covering.md
/// @cost a Dijkstra over three radii per disk, one over a radius per halving; see there for what that comes to
DiskCovering cover_by_halving(const CVertexGraph& graph, const CoveringOptions& options, const RunControl& control);

/// Starts from these disks, and adds sites until no interior site owns a boundary c-vertex, of which the paper does not speak.
/// @pre nothing was inserted yet
void cover_from(const DiskCovering& disks, const CVertexGraph& graph, Covering& covering, const RunControl& control);

}  // namespace isoatlas::detail
