// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/nesting.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// The orientation of the closed components of a mesh, see Nesting::facing; exact for all finite
/// coordinates. Parameters as below.
/// @cost  O(T); a component whose volume is so small that doubles do not determine its sign takes
///        about 100 times as long
std::vector<std::int8_t> mesh_facing(std::span<const Vec3> positions,
                                     std::span<const Triangle> triangles,
                                     std::span<const std::uint32_t> component_of,
                                     std::span<const std::uint8_t> is_open);

/// The nesting of a mesh, exact for all finite coordinates below 1e18. Where triangles intersect, a
/// component counts as enclosing a point of another one if it winds around it.
///
/// @param component_of  per vertex, < is_open.size()
/// @param is_open       per component, 1 if it has a boundary
/// @cost  O(T log T)
Nesting mesh_nesting(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                     std::span<const std::uint32_t> component_of,
                     std::span<const std::uint8_t> is_open, const RunControl& control = {});

/// The vertices around which the mesh must be refined to get the wanted nesting: those of
/// components that face the wrong way or lie in a wrong component, and those of the nearest
/// triangle of each component that wrongly encloses, or wrongly does not enclose, another one.
/// Increasing.
/// @cost  O(T) for each component that lies in a wrong component
std::vector<std::uint32_t> misplaced_vertices(std::span<const Vec3> positions,
                                              std::span<const Triangle> triangles,
                                              std::span<const std::uint32_t> component_of,
                                              const Nesting& nesting, const Nesting& wanted,
                                              const RunControl& control = {});

}  // namespace isoatlas::detail
