// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "complex/surface_complex.h"

namespace isoatlas::detail {

/// A partition of the c-vertices of a complex into cells, each with one c-vertex as its site.
struct Partition {
  std::vector<CellId> cell_of;  ///< per c-vertex, < site.size()
  std::vector<CVertexId>
      site;  ///< per cell, a c-vertex of the cell; on the boundary if the cell touches the boundary
  std::uint32_t cell_count() const { return static_cast<std::uint32_t>(site.size()); }
};

/// The dual of a partition has one triangle for every face, or half of a quad, with three different
/// cells at its corners.
struct DualTriangle {
  std::array<CellId, 3> cell;  ///< in the order of the face's corners, so oriented as the face
  CVertexId at =
      kNone;  ///< a corner of the face: where the three cells are adjacent on the surface
};

/// The dual of one face under a partition: which of its sides and diagonals lie inside a cell, and
/// which dual triangles it yields. The diagonal of a quad follows the cells: equal cells across a
/// quad are joined (A B A C), of two such pairs (A B A B) the one on the shorter diagonal, and four
/// different cells (A B C D) are split along the shorter diagonal.
struct FaceCut {
  int triangles = 0;
  std::array<DualTriangle, 2> triangle;
  CellId joined = kNone;  ///< the cell whose two opposite corners the diagonal joins, if any
  int joined_corner = 0;  ///< the first of those corners
};

/// For ABCD the diagonals are measured between the cells' sites; if `site` is empty, between the
/// face's corners.
inline FaceCut cut_face(const SurfaceComplex& complex, const Face& face,
                        const std::array<CellId, 4>& c, std::span<const CVertexId> site);

/// The dual of a certified partition: again a surface complex of triangles, homeomorphic to the
/// original. Its c-vertex i is the site of cell i.
SurfaceComplex dual_complex(const SurfaceComplex& complex, const Partition& partition,
                            std::span<const DualTriangle> triangles);

}  // namespace isoatlas::detail

#include "complex/cut_face.inl"
