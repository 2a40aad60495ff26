// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "complex/surface_complex.h"

namespace isoatlas::detail {

/// The c-vertices of a complex in cells, each with one c-vertex that stands for it.
struct Partition {
  std::vector<CellId> cell_of;  ///< per c-vertex, < site.size()
  std::vector<CVertexId> site;  ///< per cell, a c-vertex of the cell; on the boundary if the cell touches it
  std::uint32_t cell_count() const { return static_cast<std::uint32_t>(site.size()); }
};

/// The dual of a partition has one triangle for every face, or half of a quad, with three different cells at its corners.
struct DualTriangle {
  std::array<CellId, 3> cell;  ///< in the order of the face's corners, so oriented as the face
  CVertexId at = kNone;        ///< a corner of the face: where on the surface the three cells meet
};

/// How the cells of its corners cut one face: which of its sides and diagonals lie inside a cell, and which dual triangles it
/// gives. The diagonal of a quad follows the cells: equal cells across a quad are joined (A B A C), two such pairs
/// (A B A B) by the shorter diagonal, four different cells (A B C D) are split along the shorter diagonal.
struct FaceCut {
  int triangles = 0;
  std::array<DualTriangle, 2> triangle;
  CellId joined = kNone;  ///< the cell whose two opposite corners the diagonal joins, if any
  int joined_corner = 0;  ///< the first of those corners
};

/// `site` gives the points between which ABCD measures its diagonals; empty: the face's own corners.
inline FaceCut cut_face(const SurfaceComplex& complex, const Face& face, const std::array<CellId, 4>& c, std::span<const CVertexId> site);

/// The dual of a certified partition: again a surface complex, all triangles, homeomorphic to the first. Its c-vertex i is
/// the site of cell i.
SurfaceComplex dual_complex(const SurfaceComplex& complex, const Partition& partition, std::span<const DualTriangle> triangles);

}  // namespace isoatlas::detail

#include "complex/cut_face.inl"
