// SPDX-License-Identifier: Apache-2.0
// What the report of a level states about its triangles alone. `world` is a mesh with world
// lengths, `output` the same mesh in the output space.
#pragma once

#include <span>
#include <vector>

#include "isoatlas/component_extents.h"
#include "isoatlas/mesh.h"
#include "isoatlas/refine.h"
#include "isoatlas/report.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// The badly shaped triangles, worst first.
/// @param obstacles  per vertex, why it cannot be moved
/// @param goal       determines which triangles are badly shaped
std::vector<BadTriangle> bad_triangles(const MeshView& world, const MeshView& output,
                                       std::span<const ShapeObstacle> obstacles,
                                       const LevelGoal& goal);

/// Areas and volumes of `world`, bounds of `output`.
std::vector<ComponentExtent> extents_of(const TriangleMesh& world, const TriangleMesh& output,
                                        const MeshTopology& topology, const RunControl& control);

/// Counts the self-intersections of a mesh in the output space and lists the first ones.
void fill_self_intersections(const TriangleMesh& mesh, LevelReport& report,
                             const RunControl& control);

}  // namespace isoatlas::detail
