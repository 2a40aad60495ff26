// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "complex/components.h"
#include "core/nesting.h"
#include "isosurface/parse_surface.h"

namespace isoatlas::detail {

/// The nesting of a surface, computed only from the nodes on the grid's lines along z: integers and
/// signs, no coordinates.
///
/// @param nodes  all of the surface, in any order
/// @cost  O(N log N) for N nodes
Nesting surface_nesting(const Components& components, std::span<const VerticalNode> nodes);

}  // namespace isoatlas::detail
