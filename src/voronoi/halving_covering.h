// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "voronoi/covering.h"

namespace isoatlas::detail {

/// A set of disks; each holds the c-vertices nearer to its site than its radius.
struct DiskCovering {
  std::vector<CVertexId> sites;  ///< in the order in which the disks were placed
  std::vector<float> radii;      ///< per site, R_g / 2^i
};

/// Stage one as the paper describes it: bins, forbidden c-vertices, radii that are halved one at a
/// time.
///
/// Every c-vertex is in a disk; no site is in another site's disk; radii of overlapping disks
/// differ by at most a factor of two; no disk has a topological event. An alternative to
/// Covering::cover(), which it can seed.
/// @source paper, section 3.3, figures 3 to 7; choices that they leave open:
///         docs/theory/04-covering.md
/// @cost one Dijkstra search over three radii per disk and one over a radius per halving; total:
///       see there
DiskCovering cover_by_halving(const CVertexGraph& graph, const CoveringOptions& options,
                              const RunControl& control);

/// Starts a covering from these disks and inserts sites until no interior site owns a boundary
/// c-vertex, a case that the paper does not discuss.
/// @pre no site was inserted yet
void cover_from(const DiskCovering& disks, const CVertexGraph& graph, Covering& covering,
                const RunControl& control);

}  // namespace isoatlas::detail
