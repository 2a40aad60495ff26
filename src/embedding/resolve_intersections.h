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

/// The dual of a covering, of any level, while its self-intersections are resolved.
class GrowingDual {
 public:
  virtual ~GrowingDual() = default;
  virtual Covering& covering() = 0;
  /// Covers, and certifies what has changed.
  virtual void update() = 0;
  /// In sample indices, per cell; the other ones in the order of the same update.
  virtual std::vector<Vec3> positions() const = 0;
  virtual std::vector<Triangle> triangles() const = 0;
  virtual std::vector<CVertexId> sites_on_surface() const = 0;
  /// What has to be mended before intersections are looked at. @return whether there is something new to look at
  virtual bool mend_first() { return false; }
  /// Makes the complex finer around cells that are single c-vertices. @return whether that could be done
  virtual bool subdivide(std::span<const CellId> single) = 0;
};

struct ResolvedIntersections {
  std::size_t for_intersections = 0, for_nesting = 0;  ///< sites that were added
  bool any = false;                                    ///< something has changed
};

/// Makes cells smaller until the dual has no self-intersections and its components have the orientation and nesting of the surface. Of each
/// pair of triangles that intersect the largest cell becomes smaller (all six: 2 to 10 % more triangles, twice as many bad ones, and a
/// quarter less time in white noise). Where that does not help enough and cells are single c-vertices, the complex is subdivided: into
/// pieces that stay in their grid cells, and so do not intersect. That comes last: a subdivided surface has half as many c-vertices again
/// in an edge mask, and mostly it need not be. What cannot be resolved is left.
ResolvedIntersections resolve_intersections(GrowingDual& dual, const AdaptiveSurface& surface, IntersectionTracker& tracker,
                                            const RunControl& control);

/// The c-vertices of the surface, of these, around which faces can be subdivided into pieces that stay in their grid cells.
std::vector<CVertexId> subdividable(const AdaptiveSurface& surface, std::vector<CVertexId> c_vertices);

}  // namespace isoatlas::detail
