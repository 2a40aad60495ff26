// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "complex/surface_complex.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// The surfels of a complex, which sample its surface: per c-vertex a point, a unit normal and an
/// area; metric. Computed once (paper, 3.5).
struct Surfels {
  std::vector<Vec3> point;
  std::vector<Vec3>
      normal;  ///< from inside to outside; zero if the faces around the c-vertex cancel out
  std::vector<float>
      area;  ///< sum over the faces around the c-vertex, each divided evenly among its corners
};

/// O(F). 52 bytes per c-vertex.
Surfels make_surfels(const SurfaceComplex& complex, const RunControl* control = nullptr);

}  // namespace isoatlas::detail
