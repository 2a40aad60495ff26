// SPDX-License-Identifier: Apache-2.0
// The data type that represents a surface in all stages.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/ids.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// A triangle or a quad: c-vertices counter-clockwise seen from outside. corner[3] == kNone for a
/// triangle.
struct Face {
  std::array<CVertexId, 4> corner{kNone, kNone, kNone, kNone};
  bool is_triangle() const { return corner[3] == kNone; }
  int size() const { return is_triangle() ? 3 : 4; }
};

/// A side of exactly one face, in the direction of that face.
struct BoundarySide {
  CVertexId from, to;
};

/// Values of SurfaceComplex::on_boundary.
enum BoundaryKind : std::uint8_t {
  kInterior,
  kOnBoundary,
  /// On a face that the volume, a block of a larger one, shares with other blocks. Such c-vertices
  /// are vertices of every mesh and never move, so that the meshes of both blocks fit.
  kOnSharedFace,
};

/// A compact oriented 2-manifold with boundary, as a polygon complex: the dual of the isosurface's
/// surfels after parsing (one c-vertex per surfel, one face per node), and again the dual of any
/// certified partition of another complex.
///
/// Invariants (checked by validate(), relied upon everywhere):
///  - every side {a, b} of a face belongs to two faces, which run along it in opposite senses, or
///  to one, and then it is
///    listed in `boundary`;
///  - the faces at every c-vertex form one cycle, or one path whose ends are boundary sides;
///  - no two sides join the same two c-vertices, also after any choice of diagonals of the quads
///  (the dual is simplicial);
///  - every c-vertex is in a face.
///
/// Bytes per c-vertex, with about one quad per c-vertex: 24 + 16 + 1.
struct SurfaceComplex {
  Vec3 spacing{1, 1, 1};        ///< metric vector = spacing * difference of positions
  std::vector<Vec3> positions;  ///< per c-vertex, sample-index coordinates, of the upsampled
                                ///< samples if these were parsed
  std::vector<std::uint8_t> on_boundary;  ///< per c-vertex, a BoundaryKind
  std::vector<Face> faces;
  std::vector<BoundarySide> boundary;
  std::size_t double_segments =
      0;  ///< number of places where parsing split faces to keep the complex simplicial
  std::size_t tunnels = 0;  ///< number of grid cells with an annulus, see Topology::trilinear

  std::uint32_t c_vertex_count() const { return static_cast<std::uint32_t>(positions.size()); }
  std::uint32_t face_count() const { return static_cast<std::uint32_t>(faces.size()); }
};

/// Checks every invariant. O(F log F). For tests.
/// @return an empty string, or the first violated invariant and its place
std::string validate(const SurfaceComplex& complex);

}  // namespace isoatlas::detail
