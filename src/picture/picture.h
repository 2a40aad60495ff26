// SPDX-License-Identifier: Apache-2.0
// Renders a mesh to a picture file without a browser, for documents and for inspection.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "isoatlas/mesh.h"

namespace isoatlas::detail {

enum class PictureStyle : std::uint8_t {
  smooth,       ///< lit, normals interpolated between vertices, except across sharp edges
  hidden_line,  ///< visible edges, dark on white: the paper's figure 1
};

enum class PictureFormat : std::uint8_t { png, jpeg };

struct PictureOptions {
  PictureStyle style = PictureStyle::smooth;
  PictureFormat format = PictureFormat::png;
  int width = 1200, height = 900;  ///< pixels
  Vec3 view{0.45, -1, 0.35};       ///< direction from the mesh to the viewer
  /// Upward direction in the picture; default: z, or `front` if the view is along z.
  std::optional<Vec3> up;
  Vec3 front{0, -1, 0};  ///< direction to the front of a patient: -y in LPS, y in RAS
  double zoom = 1;       ///< 1: the whole mesh fits into the picture
};

/// The format of the extension .png, .jpg or .jpeg.
/// @throws Error(unsupported) for any other extension
PictureFormat picture_format(const std::filesystem::path& path);

/// Loads the library that draws pictures, isoatlas_picture.so, with VTK, X11 and OpenGL.
/// @throws Error(unsupported)  it is missing, or a library that it needs is
void require_pictures();

/// Renders the mesh on white in parallel projection. @return the bytes of a picture file
/// @throws Error(unsupported)   as require_pictures(); there is no display and no Xvfb
/// @throws Error(bad_argument)  no triangles, a size outside [16, 8192], zoom not positive, or view
///         and up zero or parallel
/// @cost   memory for at most nine times the pixels of the picture, and for a float copy of the
/// mesh
std::string picture_of(const TriangleMesh& mesh, const PictureOptions& options);

}  // namespace isoatlas::detail
