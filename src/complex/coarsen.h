// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "complex/dual_triangles.h"
#include "complex/surface_complex.h"
#include "isoatlas/certificate.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

struct Coarsened {
  SurfaceComplex complex;                 ///< all triangles; homeomorphic to the input
  std::vector<CVertexId> representative;  ///< per c-vertex of `complex`, the c-vertex of the input it stands on
  std::vector<CellId> region_of;          ///< per c-vertex of the input, the c-vertex of `complex` that stands for it
  DualTriangles triangles;                ///< the faces of `complex`
  CertificateReport certificate;          ///< of the partition; `repair_rounds` are the rounds of check and cut
};

/// A certified coarser complex: c-vertices joined within blocks of space as long as the partition they make is certified.
/// About (block / voxel)^2 times smaller where the surface is tame, as fine as the input where it is not.
///
/// @param block_length  edge of the largest blocks, world units
/// @post  homeomorphic to the input, component by component; same bytes always
/// @cost  O(C) a round, 3 to 10 rounds
Coarsened coarsen(const SurfaceComplex& complex, double block_length, const RunControl& control = {});

/// Makes a coarser complex as fine as its input in some places. Its c-vertices keep their numbers and places; new ones come after them.
///
/// @param complex  the input, or what it became by subdivision: the same c-vertices and then new ones, which are none's region yet
/// @param regions  c-vertices of the coarser complex that are to stand for one c-vertex of the input each, in any order
/// @post  as of coarsen(), where that asks for it, other regions are cut too; but only what is near the changes has been checked: see
///        certify_regions()
/// @param touched  c-vertices of `complex` that were there before, and have other faces or another place now
void cut_regions(const SurfaceComplex& complex, std::span<const CVertexId> regions, std::span<const CVertexId> touched, Coarsened& coarser,
                 const RunControl& control = {});

/// The complete certificate of the regions, after cut_regions().
/// @param complex  as there
/// @throws Error(internal) if it fails or has other faces than the coarser complex, which would be a bug
void certify_regions(const SurfaceComplex& complex, Coarsened& coarser, const RunControl& control = {});

}  // namespace isoatlas::detail
