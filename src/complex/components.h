// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "complex/surface_complex.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail {

struct Components {
  std::vector<ComponentId> of_c_vertex;     ///< numbered by smallest c-vertex
  std::vector<ComponentTopology> topology;  ///< per component
};

/// Per component, 1 if it has a boundary.
std::vector<std::uint8_t> open_flags(const Components& components);

/// Connected components with Euler characteristic V - E + F and boundary loops, counted on the
/// complex. O(C α(C)) time, 8 bytes per c-vertex.
Components find_components(const SurfaceComplex& complex);

}  // namespace isoatlas::detail
