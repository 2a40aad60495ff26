// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "complex/c_vertex_graph.h"
#include "complex/cell_members.h"
#include "complex/partition.h"
#include "core/distance_queue.h"
#include "core/epoch_set.h"
#include "isoatlas/run_control.h"
#include "voronoi/topological_event.h"

namespace isoatlas::detail {

class ComponentGraphs;

struct CoveringOptions {
  float max_radius = 0;         ///< R_g, world length, > 0
  float event_persistence = 0;  ///< world length, >= 0
  float first_stage = 0;        ///< world length > 0; see EventFinder
};

/// A disk covering of a c-vertex graph and its geodesic Voronoi partition, built site by site.
///
/// Every c-vertex x has a radius h(x), the sizing field, which is 1/3-Lipschitz in geodesic
/// distance, and stores (distance, Voronoi cell) of its nearest site; ties go to the earlier site.
/// A site v has the disk of radius h(v). An interior c-vertex is covered iff its nearest site is
/// closer than h(x), a boundary c-vertex iff it is closer than 0.55 h(x). Sites are only appended,
/// so levels are nested, and only removed from the end.
///
/// @source paper, sections 3.2 and 3.3, figures 3 to 7; the sizing field replaces bins and cascades
///         (docs/theory/04-covering.md)
class Covering {
 public:
  Covering(const CVertexGraph& graph, const CoveringOptions& options);

  /// Stage one: inserts the c-vertex farthest from all sites, its disk limited by topological
  /// events, until all c-vertices are covered. A component without a site gets its first one on its
  /// boundary if it has one. The first call covers components in parallel, with the same result as
  /// one after the other.
  void cover(const RunControl& control);

  /// Starts from sites and radii that were found on a coarser complex. @pre no site was inserted
  /// yet
  /// @param sites   become the first sites, in this order
  /// @param radii   h(radii.at) <= radii.radius + d / 3. Distances are a little longer on this
  ///                complex, so radii are raised where a c-vertex would not be covered
  struct Radius {
    CVertexId at;
    float radius;
  };
  void seed(std::span<const CVertexId> sites, std::span<const Radius> radii,
            const RunControl& control = {});

  /// Makes these c-vertices the first sites, in this order. Other c-vertices may not be covered
  /// yet; see cover(). @pre no site was inserted yet
  /// @cost  one search from all of them
  void start_with(std::span<const CVertexId> sites, const RunControl& control = {});

  /// Adapts the covering to a graph that has the old c-vertices and more. Radii are kept; they are
  /// raised where a c-vertex would not be covered. Same result as seed() with these radii, but only
  /// the neighbourhood of changed rows and of sites that moved is processed.
  /// @param changed  per c-vertex of the new graph, 1 if its row differs from the old one
  /// @param sites    per cell, a c-vertex of the cell, which becomes its site
  /// @pre   every c-vertex is covered
  void adapt_to(std::span<const std::uint8_t> changed, std::span<const CVertexId> sites,
                const RunControl& control = {});

  /// Topological events no longer limit new disks. Once the certificate has passed they need not be
  /// searched for: smaller disks inside certified cells have none that matter (paper, figure 8),
  /// and repair corrects the rest.
  void ignore_events() { events_.reset(); }

  /// Makes v a site and gives it every c-vertex that is nearer to it than to any other site.
  void insert(CVertexId v, const RunControl& control = {});
  /// Removes all sites but the first `count`. The partition becomes what it was with these sites,
  /// if the graph has not changed. Radii are kept; they are raised where a c-vertex would not be
  /// covered.
  /// @pre   every c-vertex is covered, and every component keeps a site
  /// @cost  proportional to the removed cells
  void remove_sites(std::uint32_t count, const RunControl& control = {});
  /// Per cell, the distance of its farthest c-vertex; 0 for a cell that is a single c-vertex. O(C)
  std::vector<float> farthest_distances() const;
  /// Lowers the radii at the sites of cells, each so far that the next cover() inserts a site in
  /// the cell. O(C)
  /// @return those of `cells` that are single c-vertices
  std::vector<CellId> shrink(std::span<const CellId> cells);
  /// Ensures h(x) <= radius + d(v, x) / 3.
  void lower_radius(CVertexId v, float radius, const RunControl& control = {});
  /// The same for many c-vertices in one search: much cheaper than one by one where they are near
  /// each other.
  void lower_radii(std::span<const Radius> radii, const RunControl& control = {});

  /// The c-vertices whose cell has changed since the last clear_changes(), each once. Before the
  /// first clear_changes() the list is empty and all c-vertices count as changed.
  std::span<const CVertexId> changed() const { return changed_; }
  void clear_changes();

  /// The c-vertices of each cell. O(C) for the first call; afterwards they are kept up to date.
  const CellMembers& members();

  /// Per site, the cell that its c-vertex was in when it was inserted; kNone for the first site of
  /// a component and for seeds.
  const std::vector<CellId>& inserted_in() const { return inserted_in_; }

  std::uint32_t site_count() const { return static_cast<std::uint32_t>(partition_.site.size()); }
  const Partition& partition() const { return partition_; }
  const std::vector<float>& distance() const { return distance_; }
  const std::vector<float>& radius() const { return radius_; }
  /// Whether the radii are 1/3-Lipschitz, up to float rounding. The proof in theory 4 needs this;
  /// it is asserted wherever radii change. O(C)
  bool is_lipschitz() const;
  bool is_covered(CVertexId v) const {
    return distance_[v] < (graph_.on_boundary[v] ? kBoundaryShare : 1.0f) * radius_[v];
  }

 private:
  // An interior site is at least h away from every boundary site, so with this share it cannot own
  // a boundary c-vertex.
  static constexpr float kBoundaryShare = 0.55f;

  void enqueue(CVertexId v);
  void assign_cell(CVertexId v, CellId cell);
  void add_disk(CVertexId v, const RunControl& control);  ///< inserts a site whose disk is limited
                                                          ///< by its first topological event
  void cover_reached_components(const RunControl& control);
  void cover_all(const RunControl& control);
  void cover_groups(const ComponentGraphs& groups, const RunControl& control);
  template <class Queue>
  void propagate_radii(Queue& front, const RunControl& control);
  void add_seeds(std::span<const CVertexId> sites, const RunControl& control);
  void propagate_distances(MonotoneQueue& front, const RunControl& control);
  void raise_radii_to_cover(const RunControl& control);
  void raise_radii(std::span<const CVertexId> uncovered, const RunControl& control);
  CVertexId farthest_uncovered();

  const CVertexGraph& graph_;
  CoveringOptions options_;
  std::optional<EventFinder> events_;  // none: events are ignored
  Partition partition_;
  std::vector<CellId> inserted_in_;
  std::vector<float> distance_;
  std::vector<float> radius_;
  std::vector<std::uint8_t> queued_;
  std::vector<CVertexId> changed_;
  EpochSet is_changed_;
  bool all_changed_ = true;
  CellMembers members_;
  bool has_members_ = false;
  NearestFirst front_;  // of insert() and lower_radius(); kept to reuse its memory
  FarthestFirst uncovered_boundary_, uncovered_interior_;
  std::size_t reached_ = 0;  // number of c-vertices that have a cell
  double progress_ = 0;
  CVertexId next_boundary_ = 0,
            next_interior_ = 0;  // where the search for components without a site continues
};

}  // namespace isoatlas::detail
