// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "complex/surface_complex.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// The surfels of a complex as samples of its surface: per c-vertex a point, a unit normal and an area. All with the spacing
/// applied. Made once, in the set-up stage (paper, 3.5).
struct Surfels {
  std::vector<Vec3> point;
  std::vector<Vec3> normal;  ///< from inside to outside; zero where the faces around the c-vertex cancel
  std::vector<float> area;   ///< the areas of the faces around the c-vertex, each shared out evenly among its corners
};

/// O(F). 52 bytes per c-vertex.
Surfels make_surfels(const SurfaceComplex& complex, const RunControl* control = nullptr);

}  // namespace isoatlas::detail
