// SPDX-License-Identifier: Apache-2.0
// What every level goes through on its way out.
#pragma once

#include <span>

#include "embedding/adaptive_surface.h"
#include "isoatlas/options.h"
#include "isoatlas/report.h"

namespace isoatlas::detail {

/// From sample-index coordinates, of the upsampled samples if the volume was supersampled, to those of the volume.
inline Vec3 to_volume(Vec3 index, const ExtractOptions& options) {
  const double steps = options.supersample;
  return {index.x / steps, index.y / steps, index.z / steps};
}

/// From there to the output's space.
void bring_out(TriangleMesh& mesh, const Grid& grid, const ExtractOptions& options);

/// The end of every level: the topology check, then into the output's space, where shape is measured, and self-intersections and
/// components whose orientation or nesting is not that of the surface are counted.
/// @param mesh     in sample-index coordinates; in the output's space afterwards
/// @param sites    per vertex, a c-vertex of the surface in its cell: says which component it belongs to
/// @param stays    per vertex, what keeps it where it is, for badly shaped triangles
/// @param goal     says which triangles are badly shaped
/// @param surface  the reference
/// @throws Error(internal) if the finished triangles have not, component by component, the topology of the reference
void finish_level(TriangleMesh& mesh, const MeshTopology& topology, std::span<const CVertexId> sites, const AdaptiveSurface& surface,
                  std::span<const ShapeObstacle> stays, const LevelGoal& goal, const Grid& grid, const ExtractOptions& options,
                  LevelReport& report, const RunControl& control);

}  // namespace isoatlas::detail
