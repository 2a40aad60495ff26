// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "embedding/adaptive_surface.h"
#include "geometry/intersection_tracker.h"
#include "isoatlas/mesh.h"
#include "voronoi/covering.h"

namespace isoatlas::detail {

/// The dual of a covering, at any level, while its self-intersections are resolved.
class GrowingDual {
 public:
  virtual ~GrowingDual() = default;
  virtual Covering& covering() = 0;
  virtual const SurfaceComplex& complex() const = 0;  ///< that is covered
  /// Covers, and certifies what has changed.
  virtual void update() = 0;
  /// Vertex positions per Voronoi cell, in sample-index coordinates. They, the triangles and the
  /// sites describe the dual after the last update().
  virtual std::vector<Vec3> positions() const = 0;
  virtual std::vector<Triangle> triangles() const = 0;
  virtual std::vector<CVertexId> sites_on_surface() const = 0;
  /// Repairs other faults before intersections are tested. @return whether anything has changed
  virtual bool repair_first() { return false; }
  /// Subdivides the complex around Voronoi cells that are single c-vertices.
  /// @return whether that was possible
  virtual bool subdivide(std::span<const CellId> single) = 0;
};

struct ResolvedIntersections {
  std::size_t sites_for_intersections = 0, sites_for_nesting = 0;  ///< sites that were inserted
  bool has_changed = false;                                        ///< something has changed
};

/// Makes Voronoi cells smaller until the dual has no self-intersections and its components have the
/// orientation and nesting of the surface. For each pair of intersecting triangles the largest of
/// its six Voronoi cells becomes smaller. (Making all six smaller gave 2 to 10 % more triangles,
/// twice as many badly shaped ones, and took a quarter less time for white noise.) Where that does
/// not help enough and Voronoi cells are single c-vertices, the complex is subdivided into pieces
/// that stay in their grid cells and so do not intersect. Subdivision comes last: it adds half as
/// many c-vertices again in an edge mask, and is mostly not needed. Intersections that cannot be
/// resolved remain.
///
/// If the surface is to be capped, Voronoi cells on the volume boundary become smaller until the
/// caps exist and have the right topology. In a block, those on shared faces become smaller until
/// the meshes of neighbouring blocks can only share their seams.
ResolvedIntersections resolve_intersections(GrowingDual& dual, const AdaptiveSurface& surface,
                                            IntersectionTracker& tracker,
                                            const RunControl& control);

/// Returns the c-vertices around which faces can be subdivided into pieces that stay in their grid
/// cells.
std::vector<CVertexId> filter_subdividable(const AdaptiveSurface& surface,
                                           std::vector<CVertexId> c_vertices);

}  // namespace isoatlas::detail
