// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "complex/components.h"

namespace isoatlas::detail {

/// The volumes that the components of a surface enclose when they are capped on the volume
/// boundary. Components whose capped surfaces are connected form one part: for example the two
/// sides of a slab that the volume boundary cuts open.
struct ComponentSizes {
  std::vector<std::uint32_t> part_of;  ///< per component
  std::vector<double> enclosed;        ///< per part, the volume that its surface encloses; metric
};

/// @param closed  the surface of the same volume parsed with ParseOptions::closed and otherwise
///                equal options, or `complex` itself if it has no boundary
/// @param parts   the components of `closed`
/// @cost  O(F) for the faces of both
ComponentSizes component_sizes(const SurfaceComplex& complex, const Components& components,
                               const SurfaceComplex& closed, const Components& parts);

}  // namespace isoatlas::detail
