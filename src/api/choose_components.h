// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "complex/component_sizes.h"
#include "isoatlas/options.h"
#include "isoatlas/report.h"

namespace isoatlas::detail {

struct ChosenComponents {
  std::vector<RankedComponent> kept, dropped;  ///< largest first
  std::vector<std::uint8_t> is_dropped;        ///< per component of the input
};

/// Removes from `complex` the components that the options exclude.
/// @param sizes  of `components`, which are those of `complex`
ChosenComponents choose_components(SurfaceComplex& complex, const Components& components,
                                   const ComponentSizes& sizes, const ExtractOptions& options,
                                   const Grid& grid);

}  // namespace isoatlas::detail
