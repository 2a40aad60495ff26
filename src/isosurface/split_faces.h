// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <tuple>
#include <vector>

#include "complex/surface_complex.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// A node whose face becomes a fan of triangles about it.
struct SplitNode {
  FaceId face;
  bool is_cut;                         ///< an annulus is cut there: the face has more than its four corners
  std::array<std::uint8_t, 3> border;  ///< per axis, 1 if the node is on a face of the volume normal to it
  int axis;                            ///< of the grid edge that it is on
  Vec3 position;
  std::vector<CVertexId> corners;  ///< if it is cut: those of the face, counter-clockwise
};

/// A c-vertex between the corners a and b of a face.
struct SegmentMiddle {
  FaceId face;
  CVertexId a, b, id;
};

CVertexId add_c_vertex(SurfaceComplex& complex, Vec3 position);

/// Two surfels in neighbouring cells can share both segments of an ambiguous face. Their dual edge would be there twice; so a c-vertex goes
/// on the middle of each such segment, one on each node at its ends, and the faces of those nodes become fans about the node. So do those
/// of the nodes at which an annulus is cut, since they have more than four corners.
/// @param nodes    in any order; one may be there several times
/// @param middles  in any order
void split_faces(SurfaceComplex& complex, std::vector<SplitNode> nodes, std::vector<SegmentMiddle> middles, const RunControl& control);

}  // namespace isoatlas::detail
