// SPDX-License-Identifier: Apache-2.0
// A mesh as people see it, without a browser: for documents, and for looking at what a run made.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "isoatlas/mesh.h"

namespace isoatlas::detail {

enum class PictureStyle : std::uint8_t {
  smooth,       ///< lit, normals interpolated between vertices
  hidden_line,  ///< edges that are seen, dark on white: the paper's figure 1
};

enum class PictureFormat : std::uint8_t { png, jpeg };

struct PictureOptions {
  PictureStyle style = PictureStyle::smooth;
  PictureFormat format = PictureFormat::png;
  int width = 1200, height = 900;  ///< pixels
  Vec3 view{0.45, -1, 0.35};       ///< from the mesh towards who looks at it
  std::optional<Vec3> up;  ///< upwards in the picture; none: z, or where the view is along z, -y
  double zoom = 1;         ///< 1: all of the mesh is in the picture
};

/// The format that the extension of a name says: .png, .jpg, .jpeg.
/// @throws Error(unsupported) for any other
PictureFormat picture_format(const std::filesystem::path& path);

/// The bytes of a picture file: the mesh on white in parallel projection.
/// @throws Error(unsupported)   there is no display and no Xvfb
/// @throws Error(bad_argument)  no triangles, a size outside [16, 8192], zoom not positive, view or
/// up zero or along each other
/// @cost   at most nine times the picture's pixels, and the mesh once more in float
std::string picture_of(const TriangleMesh& mesh, const PictureOptions& options);

}  // namespace isoatlas::detail
