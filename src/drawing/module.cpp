// SPDX-License-Identifier: Apache-2.0
// The module that the tool loads to draw a picture.
#include <exception>
#include <new>

#include "drawing/draw.h"
#include "isoatlas/version.h"
#include "picture/picture_module.h"

namespace isoatlas::detail {
namespace {

void draw_or_report(const TriangleMesh& mesh, const PictureOptions& options,
                    DrawnPicture& result) noexcept {
  try {
    result.bytes = drawing::draw(mesh, options);
  } catch (const Error& error) {
    result.error = error;
  } catch (const std::bad_alloc&) {
    result.error = Error(ErrorCode::out_of_memory, "not enough memory to draw the picture");
  } catch (const std::exception& error) {
    result.error = Error(ErrorCode::internal, error.what());
  }
}

}  // namespace
}  // namespace isoatlas::detail

extern "C"
    [[gnu::visibility("default")]] const isoatlas::detail::PictureModule isoatlas_picture_module;
const isoatlas::detail::PictureModule isoatlas_picture_module{ISOATLAS_VERSION,
                                                              isoatlas::detail::draw_or_report};
