// SPDX-License-Identifier: Apache-2.0
#include "voronoi/topological_event.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "core/cancel_poll.h"

namespace isoatlas::detail {
namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();

}  // namespace

EventFinder::EventFinder(const CVertexGraph& graph, float persistence, float first_stage)
    : graph_(graph),
      persistence_(persistence),
      first_stage_(first_stage),
      stamp_(graph.c_vertex_count(), 0),
      distance_(graph.c_vertex_count()),
      step_(graph.c_vertex_count()) {}

float EventFinder::event_radius(CVertexId v, float limit, const RunControl& control) {
  if (++round_ > (std::numeric_limits<std::uint32_t>::max() - 1) / 2) {
    std::fill(stamp_.begin(), stamp_.end(), 0u);
    round_ = 1;
  }
  front_.clear();
  settled_.clear();
  split_.clear();
  splits_ = 0;
  stamp_[v] = 2 * round_;
  distance_[v] = 0;
  front_.push(length_key(0, v));

  // Grow in stages. Growth beyond the limit is only needed while a split below the limit may still
  // close within the persistence.
  bool pending = false;
  for (float radius = first_stage_;; radius *= 2) {
    const float last = pending ? limit + persistence_ : limit;
    const float reach = std::min(radius, last);
    settle_up_to(reach, control);
    const bool swallowed = front_.empty();
    SplitEvents found{kNever, kNever};
    if (splits_ > 0) found = classify_splits(reach, swallowed, control);
    if (swallowed) found.event = std::min(found.event, distance_[settled_.back()]);
    if (found.event < limit && found.event <= found.pending) return found.event;
    pending = found.pending < limit;
    if (swallowed || (reach >= limit && !pending) || (pending && reach >= limit + persistence_))
      return std::min(limit, found.event);
  }
}

void EventFinder::settle_up_to(float radius, const RunControl& control) {
  CancelPoll poll(control);
  while (!front_.empty() && key_length(front_.top()) <= radius) {
    poll.step();
    const std::uint64_t key = front_.pop();
    const CVertexId w = key_id(key);
    if (stamp_[w] == 2 * round_ + 1 || key_length(key) > distance_[w]) continue;
    const int arcs = settled_arcs(w);
    if (arcs > 1) ++splits_;
    stamp_[w] = 2 * round_ + 1;
    step_[w] = static_cast<std::uint32_t>(settled_.size());
    settled_.push_back(w);
    split_.push_back(arcs > 1);
    for (const CVertexGraph::Neighbour& n : graph_.row(w)) {
      const float d = distance_[w] + n.weight;
      if (stamp_[n.id] == 2 * round_ + 1) continue;
      if (stamp_[n.id] == 2 * round_ && distance_[n.id] <= d) continue;
      stamp_[n.id] = 2 * round_;
      distance_[n.id] = d;
      front_.push(length_key(d, n.id));
    }
  }
  // Drop entries that are out of date, so that an empty front means a swallowed component.
  while (!front_.empty() && stamp_[key_id(front_.top())] == 2 * round_ + 1) front_.pop();
}

// Number of maximal runs of settled neighbours around v. Two settled sides of a quad count as
// connected through their diagonal, so the fourth corner between them does not separate them. For a
// boundary c-vertex the row is a path, closed by something that is not settled.
int EventFinder::settled_arcs(CVertexId v) const {
  const std::uint32_t begin = graph_.first[v], end = graph_.first[v + 1];
  const bool boundary = graph_.on_boundary[v];
  const auto settled = [&](std::uint32_t i) {
    return stamp_[graph_.neighbours[i].id] == 2 * round_ + 1;
  };
  const auto counts = [&](std::uint32_t i) {
    if (settled(i)) return true;
    if (!graph_.is_diagonal[i]) return false;
    return settled(i - 1) &&
           settled(i + 1 == end ? begin
                                : i + 1);  // a diagonal is never first; rows start with a side
  };
  int arcs = 0;
  bool before = boundary ? false : counts(end - 1);
  for (std::uint32_t i = begin; i < end; ++i) {
    const bool now = counts(i);
    if (now && !before) ++arcs;
    before = now;
  }
  return arcs;
}

std::uint32_t EventFinder::find(std::uint32_t i) {
  while (parent_[i] != i) {
    parent_[i] = parent_[parent_[i]];
    i = parent_[i];
  }
  return i;
}

// Decides which splits are events. Undoes the growth from the last step to the first and joins the
// components of the unsettled c-vertices; at a split this yields which components join and how high
// the lower one is. Everything beyond the reach is connected to the outside for now, so an infinite
// persistence is only certain for splits that lie deeper than the given persistence.
EventFinder::SplitEvents EventFinder::classify_splits(float reach, bool swallowed,
                                                      const RunControl& control) {
  const auto steps = static_cast<std::uint32_t>(settled_.size());
  const std::uint32_t outside = steps;
  parent_.resize(steps + 1);
  std::iota(parent_.begin(), parent_.end(), 0u);
  peak_.resize(steps + 1);
  peak_[outside] = kNever;
  SplitEvents found{kNever,
                    kNever};  // steps go down, so the last splits found have the smallest distances

  const auto unite = [&](std::uint32_t a, std::uint32_t b) {  // roots; the higher peak survives
    if (peak_[a] < peak_[b]) std::swap(a, b);
    parent_[b] = a;
    return a;
  };
  CancelPoll poll(control);
  for (std::uint32_t step = steps; step-- > 0;) {
    poll.step();
    const CVertexId w = settled_[step];
    const float d = distance_[w];
    peak_[step] = d;
    const std::uint32_t begin = graph_.first[w], end = graph_.first[w + 1];
    const auto is_settled = [&](std::uint32_t i) {
      return settled_before(graph_.neighbours[i].id, step);
    };
    const auto component_of = [&](std::uint32_t i) {
      const CVertexId u = graph_.neighbours[i].id;
      return find(stamp_[u] == 2 * round_ + 1 ? step_[u] : outside);
    };
    // A diagonal between two settled sides: these are connected through the quad, so it is neither
    // a gap nor connected to w.
    const auto is_cut_off = [&](std::uint32_t i) {
      return graph_.is_diagonal[i] && is_settled(i - 1) && is_settled(i + 1 == end ? begin : i + 1);
    };
    std::uint32_t mine = step;
    if (graph_.on_boundary[w]) mine = unite(mine, find(outside));

    if (split_[step]) {
      // One unsettled neighbour for each gap between arcs. The gap at the boundary is the outside,
      // joined above.
      std::uint32_t merged = graph_.on_boundary[w] ? mine : kNone;
      float died = -1;  // highest peak of a component that ends here; infinite for a handle
      const auto gap = [&](std::uint32_t i) {
        const std::uint32_t p = component_of(i);
        if (merged == kNone) {
          merged = p;
        } else if (merged == p) {
          died = kNever;
        } else {
          died = std::max(died, std::min(peak_[merged], peak_[p]));
          merged = unite(merged, p);
        }
      };
      // Start right after a settled neighbour, so that no gap is cut in two.
      const std::uint32_t size = end - begin;
      std::uint32_t start = 0;
      if (!graph_.on_boundary[w]) {
        while (!is_settled(begin + start)) ++start;
      }
      bool in_gap = graph_.on_boundary[w];  // the leading run belongs to the gap at the boundary
      bool leading = in_gap;
      std::uint32_t trailing =
          size;  // first entry of the trailing run, which also belongs to the gap at the boundary
      if (graph_.on_boundary[w]) {
        while (trailing > 0 && !is_settled(begin + trailing - 1)) --trailing;
      }
      for (std::uint32_t k = 0; k < size; ++k) {
        const std::uint32_t i = begin + (start + k) % size;
        if (is_settled(i)) {
          in_gap = leading = false;
          continue;
        }
        if (is_cut_off(i)) continue;
        if (!in_gap && !leading && (!graph_.on_boundary[w] || k < trailing)) gap(i);
        in_gap = true;
      }
      if (died - d >= persistence_) {
        const bool known = died < kNever || swallowed || d + persistence_ <= reach;
        (known ? found.event : found.pending) = d;
      }
      mine = find(mine);
      if (merged != kNone && find(merged) != mine) mine = unite(mine, find(merged));
    }
    for (std::uint32_t i = begin; i < end; ++i) {
      if (is_settled(i) || is_cut_off(i)) continue;
      const std::uint32_t p = component_of(i);
      mine = find(mine);
      if (p != mine) mine = unite(mine, p);
    }
  }
  return found;
}

}  // namespace isoatlas::detail
