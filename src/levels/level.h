// SPDX-License-Identifier: Apache-2.0
// The final steps for every level.
#pragma once

#include <span>

#include "embedding/adaptive_surface.h"
#include "isoatlas/options.h"
#include "isoatlas/report.h"

namespace isoatlas::detail {

/// Converts from sample-index coordinates of the supersampled volume to those of the original
/// volume.
inline Vec3 to_volume(Vec3 index, const ExtractOptions& options) {
  const double steps = options.supersample;
  return {index.x / steps, index.y / steps, index.z / steps};
}

/// Converts from sample-index coordinates to the output space.
void to_output_space(TriangleMesh& mesh, const Grid& grid, const ExtractOptions& options);

/// Completes a level: checks the topology, converts the mesh to the output space, and reports its
/// shape, its self-intersections and the components whose orientation or nesting differs from that
/// of the surface.
/// @param mesh       in sample-index coordinates; in the output space afterwards
/// @param sites      per vertex, a c-vertex of the surface in its cell, which determines its
///                   component
/// @param obstacles  per vertex, why it cannot be moved; reported with badly shaped triangles
/// @param goal       determines which triangles are badly shaped
/// @param surface    the reference
/// If the surface is to be capped, the caps are appended to the triangles, and the corners of the
/// volume's box that they need to the positions.
/// @throws Error(internal) if the triangles do not have, component by component, the topology of
///         the reference
/// @throws Error(unsupported) if the level has no caps, because self-intersections remain
void finish_level(TriangleMesh& mesh, const MeshTopology& topology,
                  std::span<const CVertexId> sites, const AdaptiveSurface& surface,
                  std::span<const ShapeObstacle> obstacles, const LevelGoal& goal, const Grid& grid,
                  const ExtractOptions& options, LevelReport& report, const RunControl& control);

/// The number of triangles in the caps of a level.
inline std::uint32_t cap_count(const LevelReport& report) {
  return report.caps ? static_cast<std::uint32_t>(report.caps->triangles) : 0;
}

}  // namespace isoatlas::detail
