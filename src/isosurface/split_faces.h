// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <tuple>
#include <vector>

#include "complex/surface_complex.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// A node whose face is replaced by a fan of triangles about it.
struct SplitNode {
  FaceId face;
  bool is_cut;  ///< an annulus is cut there, so the face has more than four corners
  std::array<std::uint8_t, 3>
      on_volume_boundary;  ///< per axis, 1 if the node is on a face of the volume normal to it
  int axis;                ///< axis of the grid edge that it is on
  Vec3 position;
  std::vector<CVertexId>
      corners;  ///< only if it is cut: the corners of the face, counter-clockwise
};

/// A c-vertex between the corners a and b of a face.
struct SegmentMidpoint {
  FaceId face;
  CVertexId a, b, id;
};

CVertexId add_c_vertex(SurfaceComplex& complex, Vec3 position);

/// Splits faces so that the complex is simplicial. Two surfels in neighbouring cells can share both
/// segments of an ambiguous face, so that the dual would have their edge twice. So a c-vertex is
/// added at the midpoint of each such segment and at each node at its ends, and the faces of these
/// nodes become fans. The same happens at nodes where an annulus is cut, since their faces have
/// more than four corners.
/// @param nodes    in any order; a node may be listed several times
/// @param middles  in any order
void split_faces(SurfaceComplex& complex, std::vector<SplitNode> nodes,
                 std::vector<SegmentMidpoint> midpoints, const RunControl& control);

}  // namespace isoatlas::detail
