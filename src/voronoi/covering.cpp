// SPDX-License-Identifier: Apache-2.0
// Stage one: a covering by disks, farthest first.
//
// Based on:
//   [gavriliu2001]  section 3.3, figures 3 to 7.
//   [dijkstra1959]  A note on two problems in connexion with graphs.
//   [peyre2006]     Geodesic remeshing using front propagation (farthest-first insertion).
#include "voronoi/covering.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <limits>
#include <thread>
#include <utility>

#include "core/cancel_poll.h"
#include "core/parallel.h"
#include "core/ranges.h"
#include "voronoi/component_graphs.h"

namespace isoatlas::detail {
namespace {

constexpr float kLipschitz = 1.0f / 3.0f;  // Lipschitz constant of the sizing field

}  // namespace

Covering::Covering(const CVertexGraph& graph, const CoveringOptions& options)
    : graph_(graph),
      options_(options),
      events_(std::in_place, graph, options.event_persistence, options.first_stage),
      distance_(graph.c_vertex_count(), std::numeric_limits<float>::infinity()),
      radius_(graph.c_vertex_count(), options.max_radius),
      queued_(graph.c_vertex_count(), 0) {
  partition_.cell_of.assign(graph.c_vertex_count(), kNone);
}

void Covering::enqueue(CVertexId v) {
  if (queued_[v]) return;
  queued_[v] = 1;
  (graph_.on_boundary[v] ? uncovered_boundary_ : uncovered_interior_)
      .push(length_key(distance_[v], ~v));
}

void Covering::clear_changes() {
  changed_.clear();
  is_changed_.clear();
  all_changed_ = false;
}

const CellMembers& Covering::members() {
  if (!std::exchange(has_members_, true)) members_ = CellMembers(partition_.cell_of, site_count());
  return members_;
}

void Covering::assign_cell(CVertexId v, CellId cell) {
  CellId& now = partition_.cell_of[v];
  if (now == cell) return;
  reached_ += now == kNone;
  if (has_members_) {
    if (now != kNone) members_.erase(v, now);
    members_.insert(v, cell);
  }
  now = cell;
  if (!all_changed_ && is_changed_.insert(v)) changed_.push_back(v);
}

void Covering::insert(CVertexId v, const RunControl& control) {
  CancelPoll poll(control);
  const CellId cell = site_count();
  partition_.site.push_back(v);
  inserted_in_.push_back(partition_.cell_of[v]);
  front_.clear();
  distance_[v] = 0;
  if (has_members_) members_.add_cells(1);
  assign_cell(v, cell);
  front_.push(length_key(0, v));
  while (!front_.empty()) {
    poll.step();
    const std::uint64_t key = front_.pop();
    const CVertexId w = key_id(key);
    if (key_length(key) > distance_[w]) continue;
    if (!is_covered(w))
      enqueue(w);  // a c-vertex of a new component, or one whose radius was just lowered
    for (const CVertexGraph::Neighbour& n : graph_.row(w)) {
      const float d = distance_[w] + n.weight;
      if (d >= distance_[n.id]) continue;  // ties go to the earlier site
      distance_[n.id] = d;
      assign_cell(n.id, cell);
      front_.push(length_key(d, n.id));
    }
  }
}

bool Covering::is_lipschitz() const {
  constexpr float kRounding = 1e-5f;
  for (CVertexId v = 0; v < graph_.c_vertex_count(); ++v) {
    for (const CVertexGraph::Neighbour& n : graph_.row(v)) {
      if (radius_[v] > (radius_[n.id] + n.weight * kLipschitz) * (1 + kRounding)) return false;
    }
  }
  return true;
}

// Distances and cells of c-vertices that keep their cell do not depend on later sites. The order of
// insertion does not matter either: a distance is the minimum over all paths, and the earliest of
// the nearest sites gets the c-vertex.
void Covering::remove_sites(std::uint32_t count, const RunControl& control) {
  CancelPoll poll(control);
  std::vector<CVertexId> unassigned;
  for (CellId c = count; c < site_count(); ++c)
    members().for_each(c, [&](CVertexId v) { unassigned.push_back(v); });
  for (const CVertexId v : unassigned) {
    poll.step();
    members_.erase(v, std::exchange(partition_.cell_of[v], kNone));
    distance_[v] = std::numeric_limits<float>::infinity();
  }
  reached_ -= unassigned.size();
  partition_.site.resize(count);
  inserted_in_.resize(count);
  if (has_members_) members_.remove_cells(count);

  MonotoneQueue front;
  for (const CVertexId v : unassigned) {
    poll.step();
    for (const CVertexGraph::Neighbour& w : graph_.row(v)) {
      if (partition_.cell_of[w.id] != kNone) front.push(length_key(distance_[w.id], w.id));
    }
  }
  propagate_distances(front, control);
  for (const CVertexId v : unassigned) {
    poll.step();
    assign_cell(v, std::exchange(partition_.cell_of[v], kNone));
  }
  std::erase_if(unassigned, [&](CVertexId v) { return is_covered(v); });
  raise_radii(unassigned, control);
  assert(is_lipschitz());
}

std::vector<float> Covering::farthest_distances() const {
  std::vector<float> farthest(site_count(), 0);
  for (CVertexId v = 0; v < distance_.size(); ++v) {
    float& farthest_in_cell = farthest[partition_.cell_of[v]];
    farthest_in_cell = std::max(farthest_in_cell, distance_[v]);
  }
  return farthest;
}

std::vector<CellId> Covering::shrink(std::span<const CellId> cells) {
  const std::vector<float> farthest = farthest_distances();
  std::vector<CellId> single;
  std::vector<Radius> lowered;
  for (const CellId c : cells) {
    if (farthest[c] == 0) {
      single.push_back(c);
      continue;
    }
    // Radii grow by a third of the distance, so with 2/3 of this distance at the site the farthest
    // c-vertex is no longer covered.
    const CVertexId site = partition_.site[c];
    lowered.push_back({site, std::min(0.7f * radius_[site], 0.66f * farthest[c])});
  }
  lower_radii(lowered);
  assert(is_lipschitz());
  return single;
}

void Covering::lower_radius(CVertexId v, float radius, const RunControl& control) {
  if (radius >= radius_[v]) return;
  front_.clear();
  radius_[v] = radius;
  front_.push(length_key(radius, v));
  propagate_radii(front_, control);
}

void Covering::lower_radii(std::span<const Radius> radii, const RunControl& control) {
  MonotoneQueue front;
  for (const Radius& r : radii) {
    if (r.radius >= radius_[r.at]) continue;
    radius_[r.at] = r.radius;
    front.push(length_key(r.radius, r.at));
  }
  propagate_radii(front, control);
}

template <class Queue>
void Covering::propagate_radii(Queue& front, const RunControl& control) {
  CancelPoll poll(control);
  while (!front.empty()) {
    poll.step();
    const std::uint64_t key = front.pop();
    const CVertexId w = key_id(key);
    if (key_length(key) > radius_[w]) continue;
    if (partition_.cell_of[w] != kNone && !is_covered(w)) enqueue(w);
    for (const CVertexGraph::Neighbour& n : graph_.row(w)) {
      const float r = radius_[w] + n.weight * kLipschitz;
      if (r >= radius_[n.id]) continue;
      radius_[n.id] = r;
      front.push(length_key(r, n.id));
    }
  }
}

void Covering::propagate_distances(MonotoneQueue& front, const RunControl& control) {
  CancelPoll poll(control);
  while (!front.empty()) {
    poll.step();
    const std::uint64_t key = front.pop();
    const CVertexId w = key_id(key);
    if (key_length(key) > distance_[w]) continue;
    for (const CVertexGraph::Neighbour& n : graph_.row(w)) {
      const float d = distance_[w] + n.weight;
      CellId& cell = partition_.cell_of[n.id];
      // Ties go to the earlier site.
      if (d > distance_[n.id] || (d == distance_[n.id] && partition_.cell_of[w] >= cell)) continue;
      distance_[n.id] = d;
      cell = partition_.cell_of[w];
      front.push(length_key(d, n.id));
    }
  }
}

void Covering::raise_radii_to_cover(const RunControl& control) {
  reached_ = 0;
  std::vector<CVertexId> uncovered;
  for (CVertexId v = 0; v < graph_.c_vertex_count(); ++v) {
    if (partition_.cell_of[v] == kNone) continue;
    ++reached_;
    if (!is_covered(v)) uncovered.push_back(v);
  }
  raise_radii(uncovered, control);
  assert(is_lipschitz());
}

// Raises the radius of each uncovered c-vertex until it is covered, and the radii around it as far
// as the Lipschitz condition requires. The result is the smallest Lipschitz sizing field that
// covers everything and is nowhere below the old one.
void Covering::raise_radii(std::span<const CVertexId> uncovered, const RunControl& control) {
  CancelPoll poll(control);
  FarthestFirst raised;
  for (const CVertexId v : uncovered) {
    radius_[v] = distance_[v] * (1.001f / (graph_.on_boundary[v] ? kBoundaryShare : 1.0f));
    raised.push(length_key(radius_[v], ~v));
  }
  while (!raised.empty()) {
    poll.step();
    const std::uint64_t key = raised.pop();
    const CVertexId v = ~key_id(key);
    if (key_length(key) < radius_[v]) continue;  // was raised further since
    for (const CVertexGraph::Neighbour& n : graph_.row(v)) {
      const float r = radius_[v] - n.weight * kLipschitz;
      if (r <= radius_[n.id]) continue;
      radius_[n.id] = r;
      raised.push(length_key(r, ~n.id));
    }
  }
}

void Covering::seed(std::span<const CVertexId> sites, std::span<const Radius> radii,
                    const RunControl& control) {
  for (const Radius& r : radii) radius_[r.at] = std::min(radius_[r.at], r.radius);
  MonotoneQueue front;
  for (const Radius& r : radii) {  // most radii do not lower any neighbour's
    const auto lowers = [&](const CVertexGraph::Neighbour& n) {
      return radius_[r.at] + n.weight * kLipschitz < radius_[n.id];
    };
    if (ranges::any_of(graph_.row(r.at), lowers)) front.push(length_key(radius_[r.at], r.at));
  }
  propagate_radii(front, control);
  add_seeds(sites, control);
  raise_radii_to_cover(control);
}

void Covering::add_seeds(std::span<const CVertexId> sites, const RunControl& control) {
  MonotoneQueue front;
  for (const CVertexId v : sites) {
    distance_[v] = 0;
    partition_.cell_of[v] = site_count();
    partition_.site.push_back(v);
    inserted_in_.push_back(kNone);
    front.push(length_key(0, v));
  }
  propagate_distances(front, control);
}

void Covering::start_with(std::span<const CVertexId> sites, const RunControl& control) {
  add_seeds(sites, control);
  for (CVertexId v = 0; v < graph_.c_vertex_count(); ++v) {
    if (partition_.cell_of[v] == kNone) continue;
    ++reached_;
    if (!is_covered(v)) enqueue(v);
  }
}

void Covering::adapt_to(std::span<const std::uint8_t> changed, std::span<const CVertexId> sites,
                        const RunControl& control) {
  const CVertexId n = graph_.c_vertex_count();
  const std::vector<CellId> cell_before = partition_.cell_of;
  const std::vector<CVertexId> site_before =
      std::exchange(partition_.site, {sites.begin(), sites.end()});
  radius_.resize(n, options_.max_radius);
  distance_.resize(n, std::numeric_limits<float>::infinity());
  partition_.cell_of.resize(n, kNone);
  queued_.resize(n, 0);
  has_members_ = false;
  next_boundary_ = next_interior_ = 0;  // there may be new components

  MonotoneQueue front;
  CancelPoll poll(control);
  for (CVertexId v = 0; v < n; ++v) {
    if (!changed[v]) continue;
    poll.step();
    for (const CVertexGraph::Neighbour& w : graph_.row(v)) {
      if (radius_[v] + w.weight * kLipschitz < radius_[w.id]) front.push(length_key(radius_[v], v));
      if (radius_[w.id] + w.weight * kLipschitz < radius_[v])
        front.push(length_key(radius_[w.id], w.id));
    }
  }
  propagate_radii(front, control);

  // A distance is the length of a path inside the cell. So distances of cells without a changed row
  // are still valid unless a shorter path has appeared. The other cells are recomputed from their
  // sites and from the cells around them.
  std::vector<std::uint8_t> is_stale(site_count(), 0);
  for (CVertexId v = 0; v < n; ++v) {
    if (changed[v] && partition_.cell_of[v] != kNone) is_stale[partition_.cell_of[v]] = 1;
  }
  for (CellId c = 0; c < site_count(); ++c) {
    const CVertexId v = sites[c];
    if (v == site_before[c]) continue;
    is_stale[c] = is_stale[partition_.cell_of[v]] = 1;
    partition_.cell_of[v] = c;
    distance_[v] = 0;
  }
  std::vector<CVertexId> stale;
  for (CVertexId v = 0; v < n; ++v) {
    const CellId cell = partition_.cell_of[v];
    if (cell != kNone && (!is_stale[cell] || partition_.site[cell] == v)) continue;
    stale.push_back(v);
    partition_.cell_of[v] = kNone;
    distance_[v] = std::numeric_limits<float>::infinity();
  }
  front.clear();
  for (const CVertexId v : stale) {
    poll.step();
    for (const CVertexGraph::Neighbour& w : graph_.row(v)) {
      if (partition_.cell_of[w.id] != kNone) front.push(length_key(distance_[w.id], w.id));
    }
  }
  for (CellId c = 0; c < site_count(); ++c) {
    if (is_stale[c]) front.push(length_key(0, partition_.site[c]));
  }
  propagate_distances(front, control);
  raise_radii_to_cover(control);

  for (CVertexId v = 0; v < n && !all_changed_; ++v) {
    const bool is_other = v >= cell_before.size() || partition_.cell_of[v] != cell_before[v];
    if (is_other && is_changed_.insert(v)) changed_.push_back(v);
  }
}

CVertexId Covering::farthest_uncovered() {
  for (FarthestFirst* queue : {&uncovered_boundary_, &uncovered_interior_}) {
    while (!queue->empty()) {
      const std::uint64_t key = queue->pop();
      const CVertexId v = ~key_id(key);
      queued_[v] = 0;
      if (is_covered(v)) continue;
      if (distance_[v] <
          key_length(key)) {  // out of date: it has become nearer since it was pushed
        enqueue(v);
        continue;
      }
      return v;
    }
  }
  return kNone;
}

void Covering::cover_reached_components(const RunControl& control) {
  for (std::size_t inserted = 0;; ++inserted) {
    if (inserted % 16 == 0) {  // event searches of large disks test for cancellation themselves
      // an upper bound: the queues also hold c-vertices that have been covered since
      const std::size_t uncovered = uncovered_boundary_.size() + uncovered_interior_.size();
      progress_ =
          std::max(progress_, static_cast<double>(reached_ - std::min(reached_, uncovered)) /
                                  graph_.c_vertex_count());
      control.report("cover", progress_);
    }
    const CVertexId v = farthest_uncovered();
    if (v == kNone) return;
    add_disk(v, control);
  }
}

void Covering::add_disk(CVertexId v, const RunControl& control) {
  if (events_) lower_radius(v, events_->event_radius(v, radius_[v], control), control);
  insert(v, control);
}

void Covering::cover(const RunControl& control) {
  if (site_count() == 0) {
    if (const ComponentGraphs groups(graph_, control); groups.count() > 1)
      return cover_groups(groups, control);
  }
  cover_all(control);
}

void Covering::cover_all(const RunControl& control) {
  const CVertexId n = graph_.c_vertex_count();
  cover_reached_components(control);
  const auto start = [&](CVertexId v) {
    add_disk(v, control);
    cover_reached_components(control);
  };
  for (; next_boundary_ < n; ++next_boundary_) {
    if (graph_.on_boundary[next_boundary_] && partition_.cell_of[next_boundary_] == kNone)
      start(next_boundary_);
  }
  for (; next_interior_ < n; ++next_interior_) {
    if (partition_.cell_of[next_interior_] == kNone) start(next_interior_);
  }
  assert(is_lipschitz());
}

// Covers each group with its own Covering and appends their sites group by group. @pre there are no
// sites
void Covering::cover_groups(const ComponentGraphs& groups, const RunControl& control) {
  std::vector<Partition> partitions(groups.count());  // their cell_of stays empty
  std::vector<std::vector<CellId>> inserted_in(groups.count());
  std::atomic<std::size_t> covered = 0;
  const std::thread::id caller = std::this_thread::get_id();
  RunControl quiet = control;
  quiet.progress = nullptr;
  for_each_index(groups.count(), 1, [&](std::size_t i) {
    const std::uint32_t group = groups.by_size()[i];
    const std::span<const CVertexId> own = groups.c_vertices(group);
    control.check_cancelled();
    const CVertexGraph graph = groups.subgraph(group, control);
    Covering group_covering(graph, options_);
    if (!events_) group_covering.ignore_events();
    for (std::size_t k = 0; k < own.size(); ++k) group_covering.radius_[k] = radius_[own[k]];
    group_covering.cover_all(quiet);
    for (std::size_t k = 0; k < own.size(); ++k) {
      distance_[own[k]] = group_covering.distance_[k];
      radius_[own[k]] = group_covering.radius_[k];
      partition_.cell_of[own[k]] = group_covering.partition_.cell_of[k];
    }
    for (CVertexId& v : group_covering.partition_.site) v = own[v];
    partitions[group].site = std::move(group_covering.partition_.site);
    inserted_in[group] = std::move(group_covering.inserted_in_);
    covered += own.size();
    if (std::this_thread::get_id() == caller)
      control.report("cover", static_cast<double>(covered) / graph_.c_vertex_count());
  });
  for (std::uint32_t group = 0; group < groups.count(); ++group) {
    const CellId first = site_count();
    control.check_cancelled();
    for (const CVertexId v : groups.c_vertices(group)) partition_.cell_of[v] += first;
    partition_.site.insert(partition_.site.end(), partitions[group].site.begin(),
                           partitions[group].site.end());
    for (const CellId cell : inserted_in[group])
      inserted_in_.push_back(cell == kNone ? kNone : first + cell);
  }
  reached_ = graph_.c_vertex_count();
  next_boundary_ = next_interior_ = graph_.c_vertex_count();
}

}  // namespace isoatlas::detail
