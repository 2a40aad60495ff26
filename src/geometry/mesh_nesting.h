// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/nesting.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// Which way the closed components of a mesh face, see Nesting::facing; exact for all finite coordinates. Parameters as below.
/// @cost  O(T); components of so little volume that doubles do not tell its sign take some 100 times as long as others
std::vector<std::int8_t> mesh_facing(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                     std::span<const std::uint32_t> component_of, std::span<const std::uint8_t> is_open);

/// The nesting of a mesh, exact for all finite coordinates below 1e18. Where triangles intersect, components around a point of
/// another one are those that wind around it.
///
/// @param component_of  per vertex, < is_open.size()
/// @param is_open       per component, 1 if it has a boundary
/// @cost  O(T log T)
Nesting mesh_nesting(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::span<const std::uint32_t> component_of,
                     std::span<const std::uint8_t> is_open, const RunControl& control = {});

/// Vertices around which the mesh has to be finer where its nesting is not the wanted one: those of components that face otherwise or
/// lie in another component, and of the nearest triangle of each component that they are in, or are not in, by mistake. Increasing.
/// @cost  O(T) for each component that lies in another one than is wanted
std::vector<std::uint32_t> misplaced_vertices(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                              std::span<const std::uint32_t> component_of, const Nesting& nesting, const Nesting& wanted,
                                              const RunControl& control = {});

}  // namespace isoatlas::detail
