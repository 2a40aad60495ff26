// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/box_faces.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// A half-edge between two vertices on the volume boundary.
struct EdgeOnBox {
  std::uint32_t from, to;
  bool is_boundary;  ///< no triangle has it in the other direction
};

/// Per vertex, the faces of the box that contain it; see BoxFaces::containing().
std::vector<std::uint8_t> faces_of_vertices(std::span<const Vec3> positions, const BoxFaces& box);

/// @param faces_of  see faces_of_vertices()
/// @cost  O(T), and O(B log B) for B half-edges on the volume boundary
std::vector<EdgeOnBox> edges_on_box(std::span<const std::uint8_t> faces_of,
                                    std::span<const Triangle> triangles);

}  // namespace isoatlas::detail
