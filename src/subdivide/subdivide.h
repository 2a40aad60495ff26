// SPDX-License-Identifier: Apache-2.0
// Adaptive supersampling of a surface complex: more c-vertices where it is too coarse, and only there.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "surface/surface_complex.h"
#include "volume/trilinear_field.h"

namespace isoatlas {

struct Subdivision {
  SurfaceComplex complex;         ///< the old c-vertices with their numbers and positions, then the new ones
  std::vector<CVertexId> origin;  ///< per new c-vertex, an old one of the same component
  /// Per new c-vertex that divides a side within a grid cell, the ends of that side; else kNone.
  std::vector<std::array<CVertexId, 2>> between;
};

/// Per c-vertex, 1 if all faces at it are triangles that lie in one grid cell each (with its walls), as those of a subdivided complex do.
std::vector<std::uint8_t> stays_in_cells(const SurfaceComplex& complex);

/// Divides all faces around some c-vertices; the others stay, so the result is a subdivision, homeomorphic to the input.
///
/// A side that crosses a wall between two grid cells is divided where the surface crosses that wall half-way between its nodes, a face
/// around a node becomes a fan about the node; so faces around a c-vertex are pieces of its own surfel then, in its own cell. Faces that
/// are so already are divided at the middles of their sides, which move onto the surface but not out of their cell or wall.
///
/// @param wanted  c-vertices, in any order
/// @param field   whose zero set is the surface
/// @cost  O(F), plus the divided faces times the logarithm of their number
Subdivision subdivide(const SurfaceComplex& complex, std::span<const CVertexId> wanted, const TrilinearField& field);

}  // namespace isoatlas
