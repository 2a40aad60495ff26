// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// Finds inverted components of a mesh: those for which the triangles' area vectors, each
/// multiplied with the outward directions at its three corners, have a negative sum. Consistent
/// orientation is guaranteed by construction and checked by counting; but a few triangles on a
/// small piece of surface can still be geometrically inverted.
///
/// @param positions     per vertex, sample-index coordinates
/// @param component_of  per vertex, < components
/// @param outward       per vertex, metric, of any length
/// @param min_cosine    a component counts as inverted if the mean cosine between triangles and
///                      outward directions is below this, e.g. 0
/// @return per component, 1 if it is inverted; a component without area is not
std::vector<std::uint8_t> inverted_components(std::span<const Vec3> positions,
                                              std::span<const Triangle> triangles, Vec3 spacing,
                                              std::span<const std::uint32_t> component_of,
                                              std::size_t components, std::span<const Vec3> outward,
                                              double min_cosine);

}  // namespace isoatlas::detail
