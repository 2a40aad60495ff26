// SPDX-License-Identifier: Apache-2.0
#include "embedding/resolve_intersections.h"

#include <algorithm>
#include <bit>

#include "complex/components.h"
#include "core/ranges.h"
#include "core/whole_progress.h"
#include "embedding/caps.h"
#include "embedding/seams.h"
#include "geometry/mesh_nesting.h"

namespace isoatlas::detail {
namespace {

// Smaller Voronoi cells count as helping while at most this share of the intersecting pairs
// remains.
constexpr double kMaxRemainingShare = 0.7;

std::vector<ComponentId> components_of(const GrowingDual& dual, const AdaptiveSurface& surface) {
  std::vector<ComponentId> out;
  for (const CVertexId v : dual.sites_on_surface())
    out.push_back(surface.components().of_c_vertex[v]);
  return out;
}

// The vertices around which the mesh must be finer for the components to have the right orientation
// and nesting. @pre no self-intersections
std::vector<CellId> find_misplaced_vertices(const GrowingDual& dual, const AdaptiveSurface& surface,
                                            std::span<const Vec3> positions,
                                            std::span<const Triangle> triangles,
                                            const RunControl& control) {
  const std::vector<ComponentId> component_of = components_of(dual, surface);
  const Nesting nesting =
      mesh_nesting(positions, triangles, component_of, open_flags(surface.components()), control);
  return misplaced_vertices(positions, triangles, component_of, nesting, surface.nesting(),
                            control);
}

// Adds the vertices around which the mesh must be finer to be capped.
void add_uncapped_vertices(const GrowingDual& dual, const AdaptiveSurface& surface,
                           std::span<const Vec3> positions, std::span<const Triangle> triangles,
                           std::vector<CellId>& cells) {
  const CapReference& reference = *surface.caps();
  std::vector<CellId> found = vertices_that_prevent_caps(positions, triangles, reference.box);
  if (cells.empty() && found.empty())
    found = make_caps(positions, triangles, components_of(dual, surface), reference,
                      surface.complex().spacing)
                .faulty;
  cells.insert(cells.end(), found.begin(), found.end());
  ranges::sort_unique(cells);
}

// Makes sites of the c-vertices on the edges of the volume's box, so that a boundary edge of the
// mesh does not cut off a part of the box. @return whether there were new ones
bool insert_sites_on_box_edges(const SurfaceComplex& complex, const BoxFaces& box,
                               Covering& covering) {
  const std::uint32_t before = covering.site_count();
  for (const BoundarySide& side : complex.boundary) {
    const CVertexId v = side.from;
    const float distance = covering.distance()[v];
    if (distance == 0 || std::popcount(box.containing(complex.positions[v])) < 2) continue;
    covering.lower_radius(v, distance);
    covering.insert(v);
  }
  return covering.site_count() > before;
}

}  // namespace

ResolvedIntersections resolve_intersections(GrowingDual& dual, const AdaptiveSurface& surface,
                                            IntersectionTracker& tracker,
                                            const RunControl& control) {
  ResolvedIntersections out;
  // 0: before the first round nothing is known, so cells that cannot become smaller are subdivided
  // at once. Waiting a round changes the number of triangles by less than 0.1 %, and not the time.
  std::size_t pairs_before = 0;
  for (;; out.has_changed = true) {
    dual.update();
    if (dual.repair_first()) continue;
    const CapReference* const caps = surface.caps();
    if (caps != nullptr && insert_sites_on_box_edges(dual.complex(), caps->box, dual.covering()))
      continue;
    const std::vector<Vec3> positions = dual.positions();
    const std::vector<Triangle> triangles = dual.triangles();
    tracker.update(positions, triangles, control);
    report_continuing(control);
    Covering& covering = dual.covering();
    const std::uint32_t before = covering.site_count();
    std::vector<CellId> cells = tracker.largest_corners(covering.farthest_distances());
    const bool is_embedded = cells.empty();
    if (is_embedded) cells = find_misplaced_vertices(dual, surface, positions, triangles, control);
    if (caps != nullptr) add_uncapped_vertices(dual, surface, positions, triangles, cells);
    if (surface.shared_faces().faces != 0) {
      const std::vector<CellId> found = vertices_that_prevent_seams(
          positions, triangles, dual.sites_on_surface(), surface.complex(), surface.shared_faces());
      cells.insert(cells.end(), found.begin(), found.end());
      ranges::sort_unique(cells);
    }
    const std::vector<CellId> single = covering.shrink(cells);
    covering.cover(
        control);  // also covers what repair_first() has left uncovered by lowering radii
    bool any = covering.site_count() > before;
    const bool has_helped =
        any && (is_embedded || static_cast<double>(tracker.pair_count()) <=
                                   kMaxRemainingShare * static_cast<double>(pairs_before));
    pairs_before = tracker.pair_count();
    if (!single.empty() && !has_helped) any = dual.subdivide(single) || any;
    (is_embedded ? out.sites_for_nesting : out.sites_for_intersections) +=
        dual.covering().site_count() - before;
    if (!any) return out;
  }
}

std::vector<CVertexId> filter_subdividable(const AdaptiveSurface& surface,
                                           std::vector<CVertexId> c_vertices) {
  const std::vector<Fineness> fineness = surface.fineness(c_vertices);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < c_vertices.size(); ++i) {
    if (fineness[i] == Fineness::faces) c_vertices[kept++] = c_vertices[i];
  }
  c_vertices.resize(kept);
  return c_vertices;
}

}  // namespace isoatlas::detail
