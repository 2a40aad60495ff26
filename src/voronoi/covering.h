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

/// A disk covering of a c-vertex graph and its geodesic Voronoi partition, grown site by site.
///
/// Every c-vertex x holds a radius h(x), 1/3-Lipschitz in geodesic distance, and (distance, cell) of its nearest site, ties to
/// the earlier site. A site v has the disk of radius h(v). x is covered iff its nearest site is closer than h(x), boundary
/// c-vertices iff closer than 0.55 h(x). Sites are only added at the end, so levels nest, and removed from the end.
///
/// @source paper, sections 3.2 and 3.3, figures 3 to 7; the radius field replaces bins and cascades (docs/theory/04-covering.md)
class Covering {
 public:
  Covering(const CVertexGraph& graph, const CoveringOptions& options);

  /// Stage one: adds the c-vertex farthest from all sites, its disk limited by topological events, until all are covered.
  /// Components without a site get one first, on their boundary if they have one. The first time components are covered in parallel, with
  /// the result that they have one after the other.
  void cover(const RunControl& control);

  /// Starts from sites and radii found on a coarser complex. @pre nothing was inserted yet
  /// @param sites   become the first sites, in this order
  /// @param radii   h(radii.at) <= radii.radius + d / 3, but for c-vertices that this would leave uncovered, since distances are
  ///                a little longer here: their radius is what covers them
  struct Radius {
    CVertexId at;
    float radius;
  };
  void seed(std::span<const CVertexId> sites, std::span<const Radius> radii, const RunControl& control = {});

  /// Goes on where the graph has the same c-vertices and more: radii stay, but where they would leave something uncovered. As seed() with
  /// these radii, but only what is near a changed row or another site is looked at.
  /// @param changed  per c-vertex of the graph as it is now, 1 if its row is not what it was
  /// @param sites    per cell, a c-vertex of the cell, its site from now on
  /// @pre   everything is covered
  void continue_on(std::span<const std::uint8_t> changed, std::span<const CVertexId> sites, const RunControl& control = {});

  /// From now on new disks are not limited by topological events: once the certificate has passed there is no need to look
  /// for them, smaller disks inside certified cells have none that matter (paper, figure 8), and repair has the last word.
  void ignore_events() { events_.reset(); }

  /// Makes v a site and gives it every c-vertex that is nearer to it than to any other.
  void insert(CVertexId v, const RunControl& control = {});
  /// Removes all sites but the first `count`. The partition is then what it was with these, if the graph is what it was. Radii stay, but
  /// where they would leave something uncovered.
  /// @pre   everything is covered, and every component keeps a site
  /// @cost  what is in the cells that are removed
  void remove_sites(std::uint32_t count, const RunControl& control = {});
  /// Per cell, the distance of its farthest c-vertex; 0 where the site is the only one. O(C)
  std::vector<float> reach() const;
  /// Makes the radii at the sites of cells smaller, each by so much that the next cover() has to divide the cell. O(C)
  /// @return those of `cells` that have no c-vertex besides their site
  std::vector<CellId> shrink(std::span<const CellId> cells);
  /// h(x) <= radius + d(v, x) / 3 from now on.
  void lower_radius(CVertexId v, float radius, const RunControl& control = {});
  /// The same of many, in one search: where they are near each other, much cheaper than one by one.
  void lower_radii(std::span<const Radius> radii, const RunControl& control = {});

  /// The c-vertices that came into another cell since the last call of forget_changes(), each once. Before the first call: none are
  /// listed, all changed.
  std::span<const CVertexId> changed() const { return changed_; }
  void forget_changes();

  /// The c-vertices of each cell. O(C) the first time; from then on they are kept up to date.
  const CellMembers& members();

  /// Per site, the cell its c-vertex was in when it was inserted; kNone for the first of a component and for seeds.
  const std::vector<CellId>& placed_in() const { return placed_in_; }

  std::uint32_t site_count() const { return static_cast<std::uint32_t>(partition_.site.size()); }
  const Partition& partition() const { return partition_; }
  const std::vector<float>& distance() const { return distance_; }
  const std::vector<float>& radius() const { return radius_; }
  /// Whether the radii are 1/3-Lipschitz, up to float rounding. The proof in theory 4 needs it; asserted wherever radii change. O(C)
  bool has_slope() const;
  bool is_covered(CVertexId v) const { return distance_[v] < (graph_.on_boundary[v] ? kBoundaryShare : 1.0f) * radius_[v]; }

 private:
  // An interior site is at least h away from every boundary site, so with this share it cannot own a boundary c-vertex.
  static constexpr float kBoundaryShare = 0.55f;

  void enqueue(CVertexId v);
  void put_in_cell(CVertexId v, CellId cell);
  void add_disk(CVertexId v, const RunControl& control);  ///< a site whose disk is limited by its first topological event
  void cover_reached(const RunControl& control);
  void cover_all(const RunControl& control);
  void cover_apart(const ComponentGraphs& groups, const RunControl& control);
  template <class Queue>
  void spread_radii(Queue& front, const RunControl& control);
  void spread_distances(MonotoneQueue& front, const RunControl& control);
  void cover_by_radii(const RunControl& control);
  void raise_radii(std::span<const CVertexId> uncovered, const RunControl& control);
  CVertexId farthest_uncovered();

  const CVertexGraph& graph_;
  CoveringOptions options_;
  std::optional<EventFinder> events_;  // none: not watched for
  Partition partition_;
  std::vector<CellId> placed_in_;
  std::vector<float> distance_;
  std::vector<float> radius_;
  std::vector<std::uint8_t> queued_;
  std::vector<CVertexId> changed_;
  EpochSet is_changed_;
  bool all_changed_ = true;
  CellMembers members_;
  bool has_members_ = false;
  NearestFirst front_;  // of one disk
  FarthestFirst uncovered_boundary_, uncovered_interior_;
  std::size_t reached_ = 0;  // c-vertices in some cell
  double progress_ = 0;
  CVertexId next_boundary_ = 0, next_interior_ = 0;  // where to look for components without a site
};

}  // namespace isoatlas::detail
