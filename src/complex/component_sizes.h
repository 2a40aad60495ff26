// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "complex/components.h"

namespace isoatlas::detail {

/// How much the components of a surface enclose, with the volume's border capped. Components whose capped surfaces are
/// connected are one part: the two sides of a slab that the border cuts open, for example.
struct ComponentSizes {
  std::vector<std::uint32_t> part_of;  ///< per component
  std::vector<double> enclosed;        ///< per part: the volume that its surface encloses, in the metric (spacing applied)
};

/// @param closed  the surface of the same volume by the same options but ParseOptions::closed; or `complex` itself if it has no boundary
/// @cost  O(F) for the faces of both
ComponentSizes component_sizes(const SurfaceComplex& complex, const Components& components, const SurfaceComplex& closed);

}  // namespace isoatlas::detail
