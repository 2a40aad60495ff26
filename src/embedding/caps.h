// SPDX-License-Identifier: Apache-2.0
// Caps close a surface that the volume boundary cuts: they are the parts of the six faces of the
// volume's box that are inside.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "complex/component_sizes.h"
#include "geometry/box_faces.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// What the capped surface has to be.
struct CapReference {
  BoxFaces box;                             ///< of the parsed samples
  std::array<bool, 8> corner_is_inside{};   ///< per corner of the box; see BoxFaces::corner()
  std::vector<std::uint32_t> part_of;       ///< per component of the open surface
  std::vector<ComponentTopology> topology;  ///< per part
  /// The part that is the whole surface of the box, the only one without a component of the open
  /// surface; kNone if no part is.
  std::uint32_t whole_box = kNone;
};

/// @param closed   the surface of the same volume parsed with ParseOptions::closed
/// @param parts    its components
/// @param part_of  per component of the open surface
/// @param is_dropped  per component of the open surface, 1 if it is not meshed; empty: all are.
///                    CapReference::part_of has the others
CapReference make_cap_reference(const SurfaceComplex& closed, const Components& parts,
                                std::span<const std::uint32_t> part_of,
                                std::span<const std::uint8_t> is_dropped, const BoxFaces& box);

/// Finds where a mesh does not permit caps that only share its boundary: boundary edges that are
/// not on exactly one face of the box, and other edges or triangles that are on one.
/// @param positions  in sample-index coordinates
/// @return their vertices, sorted
/// @cost  O(V + T), and O(B log B) for B vertices on the volume boundary
std::vector<std::uint32_t> vertices_that_prevent_caps(std::span<const Vec3> positions,
                                                      std::span<const Triangle> triangles,
                                                      const BoxFaces& box);

struct Caps {
  /// Corners below the number of vertices are vertices of the mesh; the others are `corners`.
  std::vector<Triangle> triangles;
  std::vector<Vec3> corners;          ///< the corners of the box that are inside
  std::vector<std::uint32_t> faulty;  ///< vertices at which the mesh must be finer for the caps to
                                      ///< exist and to have the right topology; sorted
};

/// Caps a mesh: a Delaunay triangulation per face of the box, with no vertices but those of the
/// mesh's boundary and the corners of the box.
/// @param positions     in sample-index coordinates
/// @param component_of  per vertex, its component of the open surface
/// @pre   vertices_that_prevent_caps() is empty, and the mesh has no self-intersections
/// @post  if `faulty` is empty, the mesh and its caps are closed, and each part has the Euler
///        characteristic of the reference
/// @cost  O(V + T), and O(B log B) for B vertices on the volume boundary
Caps make_caps(std::span<const Vec3> positions, std::span<const Triangle> triangles,
               std::span<const ComponentId> component_of, const CapReference& reference,
               Vec3 spacing);

}  // namespace isoatlas::detail
