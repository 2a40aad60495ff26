// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "isoatlas/error.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// @throws Error(bad_argument) if a triangle has a corner that is not a vertex of the mesh
inline void require_corners(const MeshView& mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (v < mesh.positions.size()) continue;
      throw Error(ErrorCode::bad_argument, "triangle " + std::to_string(t) + " uses vertex " +
                                               std::to_string(v) + ", but there are only " +
                                               std::to_string(mesh.positions.size()));
    }
  }
}

}  // namespace isoatlas::detail
