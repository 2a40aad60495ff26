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
  SurfaceComplex complex;  ///< all triangles; homeomorphic to the input
  std::vector<CVertexId>
      representative;  ///< per c-vertex of `complex`, the c-vertex of the input at its position
  std::vector<CellId>
      region_of;  ///< per c-vertex of the input, the c-vertex of `complex` that represents it
  DualTriangles triangles;  ///< the faces of `complex`
  CertificateReport
      certificate;  ///< of the partition; `repair_rounds` counts the rounds of checks and splits
};

/// A certified coarser complex: c-vertices are joined within blocks of space as long as the
/// resulting partition is certified. It is about (block / voxel)^2 times smaller where the surface
/// is smooth, and as fine as the input where it is not.
///
/// @param block_length  edge of the largest blocks, world units
/// @post  homeomorphic to the input, component by component; deterministic
/// @cost  O(C) per round, 3 to 10 rounds
Coarsened coarsen(const SurfaceComplex& complex, double block_length,
                  const RunControl& control = {});

/// Refines a coarser complex to its input in some places. Its c-vertices keep their ids and
/// positions; new ones are appended.
///
/// @param complex  the input, or a subdivision of it: the same c-vertices, followed by new ones
///                 that have no region yet
/// @param regions  c-vertices of the coarser complex to be split into single c-vertices of the
///                 input, in any order
/// @param touched  c-vertices of `complex` that existed before and have other faces or another
///                 position now
/// @post  as of coarsen(), which may require that other regions are split too; but only the
///        neighbourhood of the changes was checked: see certify_regions()
void split_regions(const SurfaceComplex& complex, std::span<const CVertexId> regions,
                   std::span<const CVertexId> touched, Coarsened& coarser,
                   const RunControl& control = {});

/// Computes the complete certificate of the regions, after split_regions().
/// @param complex  the same as there
/// @throws Error(internal) if it fails or its faces differ from the coarser complex, which would be
///         a bug
void certify_regions(const SurfaceComplex& complex, Coarsened& coarser,
                     const RunControl& control = {});

}  // namespace isoatlas::detail
