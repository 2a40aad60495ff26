// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "complex/components.h"

namespace isoatlas::detail {

/// Removes whole components; the other c-vertices and faces keep their order. O(F).
/// @param dropped  per component, 1 if it is removed
void drop_components(SurfaceComplex& complex, const Components& components,
                     const std::vector<std::uint8_t>& dropped);

}  // namespace isoatlas::detail
