// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "complex/surface_complex.h"
#include "field/classify.h"
#include "geometry/box_faces.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

struct ParseOptions {
  InsideRule rule;
  bool vertices_on_surface =
      true;  ///< Newton steps onto the isosurface; false: plain average of the nodes
  Topology topology = Topology::trilinear;
  Interpolation interpolation = Interpolation::trilinear;  ///< on which surface points are placed
  std::uint32_t supersample =
      1;  ///< >= 1: parses the volume upsampled by this factor per axis, see UpsampledField
  /// Points beyond the volume are not inside: the surface is closed by faces on the volume
  /// boundary.
  bool closed = false;
  /// Faces that the volume, a block of a larger one, shares with other blocks. There, each node is
  /// a c-vertex, so that the c-vertices and boundary sides of a face depend on its samples alone:
  /// both blocks have the same ones, kOnSharedFace. Otherwise nodes would become c-vertices where
  /// only one of the blocks needs them. @pre not closed
  SharedFaces shared{};
};

/// Where the surface crosses a grid edge along z.
struct VerticalNode {
  std::uint32_t x, y,
      z;  ///< the sample at the lower end; of the upsampled samples if these were parsed
  CVertexId c_vertex;  ///< one of the c-vertices around it
  bool outside_is_up;  ///< the lower end is inside
};

/// The reference surface of a volume at an isovalue, as a surface complex: one c-vertex per surfel,
/// one face per node.
///
/// Inside is decided by the samples alone; ambiguous faces by the asymptotic decider, exactly, with
/// ties joined inside; inside a grid cell the topology is that of the trilinear interpolant, or one
/// disk per loop (docs/theory/01-surface.md). The volume is extended by one layer of zero
/// thickness, so that a surface cut by the volume boundary ends in boundary c-vertices that lie
/// exactly on it. With supersampling all of this applies to the upsampled samples: positions are in
/// their index and the spacing is theirs, so that grid cells are unit boxes for any factor.
///
/// @param nodes  if not null, gets all nodes on edges along z. @pre not ParseOptions::closed
/// @pre    every size >= 2, spacing > 0, isovalue finite
/// @throws Error(unsupported) non-finite samples that the rule refuses; Error(bad_argument) too
///         many samples after supersampling
/// @return an empty complex if all samples are on one side
/// @post   same bytes for any number of threads
/// @cost   O(N) for N samples, one pass over them; then O(C) for C c-vertices. With supersampling
///         N/8 bytes for N upsampled samples
/// @source paper section 3.2; deviations: docs/theory/01-surface.md
SurfaceComplex parse_surface(const VolumeView& volume, const ParseOptions& options,
                             const RunControl& control = {},
                             std::vector<VerticalNode>* nodes = nullptr);

}  // namespace isoatlas::detail
