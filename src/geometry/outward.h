// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// Components of a mesh that do not face outward: the triangles' area vectors, each against the outward directions at its
/// three corners, do not add up to something positive. Orientation as such is right by construction and checked by counting;
/// but a handful of triangles about a small piece of surface can still be geometrically inside out.
///
/// @param positions     per vertex, sample-index coordinates
/// @param component_of  per vertex, < components
/// @param outward       per vertex, with the spacing applied, of any length
/// @param least         a mean cosine between triangles and outward directions below this counts as turned, e.g. 0
/// @return per component, 1 if it does not face outward; a component without area does
std::vector<std::uint8_t> turned_components(std::span<const Vec3> positions, std::span<const Triangle> triangles, Vec3 spacing,
                                            std::span<const std::uint32_t> component_of, std::size_t components,
                                            std::span<const Vec3> outward, double least);

}  // namespace isoatlas::detail
