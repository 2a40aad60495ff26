// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "isoatlas/mesh.h"

namespace isoatlas::detail::io {

/// A mesh with positions that are whole numbers.
struct IntegerMesh {
  std::vector<std::array<std::int32_t, 3>> positions;
  std::vector<Triangle> triangles;
};

/// Compresses a mesh with Draco, without loss; vertices and triangles may change their order.
/// @throws Error(internal) if that fails
std::string draco_bytes(const IntegerMesh& mesh);

/// @throws Error(internal) if these are not the bytes of draco_bytes()
IntegerMesh mesh_of_draco(const std::string& bytes);

}  // namespace isoatlas::detail::io
