// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surface/components.h"

namespace isoatlas {

/// Size of every component, in the metric (spacing applied): the volume it encloses; of one that the volume's border cuts open,
/// which encloses none, the volume of a ball of the same area, so that it counts for no less than it could enclose. O(F).
std::vector<double> component_volumes(const SurfaceComplex& complex, const Components& components);

/// Removes whole components; c-vertices and faces that stay keep their order. O(F).
/// @param dropped  per component, 1 if it goes
void drop_components(SurfaceComplex& complex, const Components& components, const std::vector<std::uint8_t>& dropped);

}  // namespace isoatlas
