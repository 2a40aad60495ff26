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
#include "voronoi/component_graphs.h"

namespace isoatlas::detail {
namespace {

constexpr float kSlope = 1.0f / 3.0f;  // of radii along the surface, at most

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
  (graph_.on_boundary[v] ? uncovered_boundary_ : uncovered_interior_).push(length_key(distance_[v], ~v));
}

void Covering::forget_changes() {
  changed_.clear();
  is_changed_.clear();
  all_changed_ = false;
}

const CellMembers& Covering::members() {
  if (!std::exchange(has_members_, true)) members_ = CellMembers(partition_.cell_of, site_count());
  return members_;
}

void Covering::put_in_cell(CVertexId v, CellId cell) {
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
  placed_in_.push_back(partition_.cell_of[v]);
  front_.clear();
  distance_[v] = 0;
  if (has_members_) members_.add_cells(1);
  put_in_cell(v, cell);
  front_.push(length_key(0, v));
  while (!front_.empty()) {
    poll.step();
    const std::uint64_t key = front_.pop();
    const CVertexId w = key_id(key);
    if (key_length(key) > distance_[w]) continue;
    if (!is_covered(w)) enqueue(w);  // only a c-vertex of a new component, or one whose radius was lowered just now
    for (const CVertexGraph::Neighbour& n : graph_.row(w)) {
      const float d = distance_[w] + n.weight;
      if (d >= distance_[n.id]) continue;  // equal distances stay with the earlier site
      distance_[n.id] = d;
      put_in_cell(n.id, cell);
      front_.push(length_key(d, n.id));
    }
  }
}

bool Covering::has_slope() const {
  constexpr float kRounding = 1e-5f;
  for (CVertexId v = 0; v < graph_.c_vertex_count(); ++v) {
    for (const CVertexGraph::Neighbour& n : graph_.row(v)) {
      if (radius_[v] > (radius_[n.id] + n.weight * kSlope) * (1 + kRounding)) return false;
    }
  }
  return true;
}

// Distances and cells of the c-vertices that stay in their cells do not depend on later sites. (Nor does it matter in which order sites
// come: distances are the smallest over all paths, and of equal ones the earliest site has the c-vertex.)
void Covering::remove_sites(std::uint32_t count, const RunControl& control) {
  CancelPoll poll(control);
  std::vector<CVertexId> freed;
  for (CellId c = count; c < site_count(); ++c) members().for_each(c, [&](CVertexId v) { freed.push_back(v); });
  for (const CVertexId v : freed) {
    poll.step();
    members_.erase(v, std::exchange(partition_.cell_of[v], kNone));
    distance_[v] = std::numeric_limits<float>::infinity();
  }
  reached_ -= freed.size();
  partition_.site.resize(count);
  placed_in_.resize(count);
  if (has_members_) members_.remove_cells(count);

  MonotoneQueue front;
  for (const CVertexId v : freed) {
    poll.step();
    for (const CVertexGraph::Neighbour& w : graph_.row(v)) {
      if (partition_.cell_of[w.id] != kNone) front.push(length_key(distance_[w.id], w.id));
    }
  }
  spread_distances(front, control);
  for (const CVertexId v : freed) {
    poll.step();
    put_in_cell(v, std::exchange(partition_.cell_of[v], kNone));
  }
  std::erase_if(freed, [&](CVertexId v) { return is_covered(v); });
  raise_radii(freed, control);
  assert(has_slope());
}

std::vector<float> Covering::reach() const {
  std::vector<float> farthest(site_count(), 0);
  for (CVertexId v = 0; v < distance_.size(); ++v) {
    float& most = farthest[partition_.cell_of[v]];
    most = std::max(most, distance_[v]);
  }
  return farthest;
}

std::vector<CellId> Covering::shrink(std::span<const CellId> cells) {
  const std::vector<float> farthest = reach();
  std::vector<CellId> single;
  std::vector<Radius> lower;
  for (const CellId c : cells) {
    if (farthest[c] == 0) {
      single.push_back(c);
      continue;
    }
    // Radii rise by a third of the distance: with two thirds of it at the site the farthest c-vertex is not covered any more.
    const CVertexId site = partition_.site[c];
    lower.push_back({site, std::min(0.7f * radius_[site], 0.66f * farthest[c])});
  }
  lower_radii(lower);
  assert(has_slope());
  return single;
}

void Covering::lower_radius(CVertexId v, float radius, const RunControl& control) {
  if (radius >= radius_[v]) return;
  front_.clear();
  radius_[v] = radius;
  front_.push(length_key(radius, v));
  spread_radii(front_, control);
}

void Covering::lower_radii(std::span<const Radius> radii, const RunControl& control) {
  MonotoneQueue front;
  for (const Radius& r : radii) {
    if (r.radius >= radius_[r.at]) continue;
    radius_[r.at] = r.radius;
    front.push(length_key(r.radius, r.at));
  }
  spread_radii(front, control);
}

template <class Queue>
void Covering::spread_radii(Queue& front, const RunControl& control) {
  CancelPoll poll(control);
  while (!front.empty()) {
    poll.step();
    const std::uint64_t key = front.pop();
    const CVertexId w = key_id(key);
    if (key_length(key) > radius_[w]) continue;
    if (partition_.cell_of[w] != kNone && !is_covered(w)) enqueue(w);
    for (const CVertexGraph::Neighbour& n : graph_.row(w)) {
      const float r = radius_[w] + n.weight * kSlope;
      if (r >= radius_[n.id]) continue;
      radius_[n.id] = r;
      front.push(length_key(r, n.id));
    }
  }
}

void Covering::spread_distances(MonotoneQueue& front, const RunControl& control) {
  CancelPoll poll(control);
  while (!front.empty()) {
    poll.step();
    const std::uint64_t key = front.pop();
    const CVertexId w = key_id(key);
    if (key_length(key) > distance_[w]) continue;
    for (const CVertexGraph::Neighbour& n : graph_.row(w)) {
      const float d = distance_[w] + n.weight;
      CellId& cell = partition_.cell_of[n.id];
      // Equal distances go to the earlier site.
      if (d > distance_[n.id] || (d == distance_[n.id] && partition_.cell_of[w] >= cell)) continue;
      distance_[n.id] = d;
      cell = partition_.cell_of[w];
      front.push(length_key(d, n.id));
    }
  }
}

void Covering::cover_by_radii(const RunControl& control) {
  reached_ = 0;
  std::vector<CVertexId> uncovered;
  for (CVertexId v = 0; v < graph_.c_vertex_count(); ++v) {
    if (partition_.cell_of[v] == kNone) continue;
    ++reached_;
    if (!is_covered(v)) uncovered.push_back(v);
  }
  raise_radii(uncovered, control);
  assert(has_slope());
}

// Radii that leave something uncovered become those that cover it, and those around them rise as far as the slope asks for: of all
// radii with that slope that cover everything and are nowhere below those there were, the smallest.
void Covering::raise_radii(std::span<const CVertexId> uncovered, const RunControl& control) {
  CancelPoll poll(control);
  FarthestFirst rising;
  for (const CVertexId v : uncovered) {
    radius_[v] = distance_[v] * (1.001f / (graph_.on_boundary[v] ? kBoundaryShare : 1.0f));
    rising.push(length_key(radius_[v], ~v));
  }
  while (!rising.empty()) {
    poll.step();
    const std::uint64_t key = rising.pop();
    const CVertexId v = ~key_id(key);
    if (key_length(key) < radius_[v]) continue;  // has risen more since
    for (const CVertexGraph::Neighbour& n : graph_.row(v)) {
      const float r = radius_[v] - n.weight * kSlope;
      if (r <= radius_[n.id]) continue;
      radius_[n.id] = r;
      rising.push(length_key(r, ~n.id));
    }
  }
}

void Covering::seed(std::span<const CVertexId> sites, std::span<const Radius> radii, const RunControl& control) {
  for (const Radius& r : radii) radius_[r.at] = std::min(radius_[r.at], r.radius);
  MonotoneQueue front;
  for (const Radius& r : radii) {  // most radii lower none beside them
    const auto lowers = [&](const CVertexGraph::Neighbour& n) { return radius_[r.at] + n.weight * kSlope < radius_[n.id]; };
    if (std::ranges::any_of(graph_.row(r.at), lowers)) front.push(length_key(radius_[r.at], r.at));
  }
  spread_radii(front, control);

  front.clear();
  for (const CVertexId v : sites) {
    distance_[v] = 0;
    partition_.cell_of[v] = site_count();
    partition_.site.push_back(v);
    placed_in_.push_back(kNone);
    front.push(length_key(0, v));
  }
  spread_distances(front, control);
  cover_by_radii(control);
}

void Covering::continue_on(std::span<const std::uint8_t> changed, std::span<const CVertexId> sites, const RunControl& control) {
  const CVertexId n = graph_.c_vertex_count();
  const std::vector<CellId> cell_before = partition_.cell_of;
  const std::vector<CVertexId> site_before = std::exchange(partition_.site, {sites.begin(), sites.end()});
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
      if (radius_[v] + w.weight * kSlope < radius_[w.id]) front.push(length_key(radius_[v], v));
      if (radius_[w.id] + w.weight * kSlope < radius_[v]) front.push(length_key(radius_[w.id], w.id));
    }
  }
  spread_radii(front, control);

  // A cell's distances are lengths of paths in the cell. So those of cells in which no row changed are still right, unless there are
  // shorter paths now; the others are found anew, from their sites and from the cells around.
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
  spread_distances(front, control);
  cover_by_radii(control);

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
      if (distance_[v] < key_length(key)) {  // nearer now than when it was filed
        enqueue(v);
        continue;
      }
      return v;
    }
  }
  return kNone;
}

void Covering::cover_reached(const RunControl& control) {
  for (std::size_t inserted = 0;; ++inserted) {
    if (inserted % 16 == 0) {  // large disks ask whether to stop while they look for events
      const std::size_t uncovered = uncovered_boundary_.size() + uncovered_interior_.size();  // some are covered by now
      progress_ = std::max(progress_, static_cast<double>(reached_ - std::min(reached_, uncovered)) / graph_.c_vertex_count());
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
    if (const ComponentGraphs groups(graph_, control); groups.count() > 1) return cover_apart(groups, control);
  }
  cover_all(control);
}

void Covering::cover_all(const RunControl& control) {
  const CVertexId n = graph_.c_vertex_count();
  cover_reached(control);
  const auto start = [&](CVertexId v) {
    add_disk(v, control);
    cover_reached(control);
  };
  for (; next_boundary_ < n; ++next_boundary_) {
    if (graph_.on_boundary[next_boundary_] && partition_.cell_of[next_boundary_] == kNone) start(next_boundary_);
  }
  for (; next_interior_ < n; ++next_interior_) {
    if (partition_.cell_of[next_interior_] == kNone) start(next_interior_);
  }
  assert(has_slope());
}

// Each group by a covering of its own; then their sites one group after the other. @pre there are no sites
void Covering::cover_apart(const ComponentGraphs& groups, const RunControl& control) {
  std::vector<Partition> parts(groups.count());  // their cell_of stays empty
  std::vector<std::vector<CellId>> placed_in(groups.count());
  std::atomic<std::size_t> covered = 0;
  const std::thread::id caller = std::this_thread::get_id();
  RunControl quiet = control;
  quiet.progress = nullptr;
  for_each_index(groups.count(), 1, [&](std::size_t i) {
    const std::uint32_t group = groups.by_size()[i];
    const std::span<const CVertexId> own = groups.c_vertices(group);
    control.check_cancelled();
    const CVertexGraph graph = groups.graph_of(group, control);
    Covering part(graph, options_);
    if (!events_) part.ignore_events();
    for (std::size_t k = 0; k < own.size(); ++k) part.radius_[k] = radius_[own[k]];
    part.cover_all(quiet);
    for (std::size_t k = 0; k < own.size(); ++k) {
      distance_[own[k]] = part.distance_[k];
      radius_[own[k]] = part.radius_[k];
      partition_.cell_of[own[k]] = part.partition_.cell_of[k];
    }
    for (CVertexId& v : part.partition_.site) v = own[v];
    parts[group].site = std::move(part.partition_.site);
    placed_in[group] = std::move(part.placed_in_);
    covered += own.size();
    if (std::this_thread::get_id() == caller) control.report("cover", static_cast<double>(covered) / graph_.c_vertex_count());
  });
  for (std::uint32_t group = 0; group < groups.count(); ++group) {
    const CellId first = site_count();
    control.check_cancelled();
    for (const CVertexId v : groups.c_vertices(group)) partition_.cell_of[v] += first;
    partition_.site.insert(partition_.site.end(), parts[group].site.begin(), parts[group].site.end());
    for (const CellId cell : placed_in[group]) placed_in_.push_back(cell == kNone ? kNone : first + cell);
  }
  reached_ = graph_.c_vertex_count();
  next_boundary_ = next_interior_ = graph_.c_vertex_count();
}

}  // namespace isoatlas::detail
