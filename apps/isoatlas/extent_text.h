// SPDX-License-Identifier: Apache-2.0
// Bounds, areas and volumes as text.
#pragma once

#include <ostream>
#include <string>

#include "isoatlas/component_extents.h"
#include "isoatlas/length_unit.h"

namespace isoatlas::detail::tool {

/// "12.5 cubic mm"; "12.5 cubic units" if the unit is unknown.
std::string volume_text(double volume, LengthUnit unit);

/// Prints the bounds, the area and the enclosed volume of a mesh and of its largest components.
/// @param unit       of areas and volumes
/// @param bounds_in  the unit of the bounds: "mm", "samples"; empty if it is unknown
void print_extent(std::ostream& out, const MeshExtent& extent, LengthUnit unit,
                  const std::string& bounds_in);

}  // namespace isoatlas::detail::tool
