// SPDX-License-Identifier: Apache-2.0
// What isoatlas_picture.so exports: a PictureModule with the name kPictureModule.
#pragma once

#include <optional>
#include <string>

#include "isoatlas/error.h"
#include "isoatlas/mesh.h"
#include "picture/picture.h"

namespace isoatlas::detail {

inline constexpr const char* kPictureModule = "isoatlas_picture_module";

struct DrawnPicture {
  std::string bytes;
  std::optional<Error> error;  ///< set if the picture could not be drawn
};

struct PictureModule {
  const char* version;  ///< of isoatlas; modules of other versions have other types
  void (*draw)(const TriangleMesh& mesh, const PictureOptions& options,
               DrawnPicture& result) noexcept;
};

}  // namespace isoatlas::detail
