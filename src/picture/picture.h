// SPDX-License-Identifier: Apache-2.0
// A mesh as people see it, without a browser: for documents, and for looking at what a run made.
#pragma once

#include <cstdint>
#include <string>

#include "isoatlas/mesh.h"

namespace isoatlas {

enum class PictureStyle : std::uint8_t {
  smooth,       ///< lit, normals interpolated between vertices
  hidden_line,  ///< edges that are seen, dark on white: the paper's figure 1
};

struct PictureOptions {
  PictureStyle style = PictureStyle::smooth;
  int width = 1200, height = 900;  ///< pixels
  Vec3 view{0.45, -1, 0.35};       ///< from the mesh towards who looks at it
  Vec3 up{0, 0, 1};                ///< upwards in the picture
  double zoom = 1;                 ///< 1: all of the mesh is in the picture
};

/// The mesh on white, as PNG, in parallel projection.
/// @throws Error(unsupported)   there is no display and no Xvfb
/// @throws Error(bad_argument)  no triangles, a size outside [16, 8192], zoom not positive, view or up zero or along each other
/// @cost   at most nine times the picture's pixels, and the mesh once more in float
std::string picture_png(const TriangleMesh& mesh, const PictureOptions& options);

}  // namespace isoatlas
