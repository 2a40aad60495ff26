// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "isoatlas/mesh.h"
#include "picture/picture.h"

namespace isoatlas::detail::drawing {

/// picture_of(), by VTK in this process.
std::string draw(const TriangleMesh& mesh, const PictureOptions& options);

}  // namespace isoatlas::detail::drawing
