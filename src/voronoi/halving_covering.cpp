// SPDX-License-Identifier: Apache-2.0
// Stage one as the paper describes it.
//
// Based on:
//   [gavriliu2001]  section 3.3, figures 3 (the loop), 4 (events), 5 (bins), 7 (halving).
// Choices that the figures leave open, and corrections to them: docs/theory/04-covering.md.
#include "voronoi/halving_covering.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isoatlas::detail {
namespace {

using DiskId = std::uint32_t;

class Halving {
 public:
  Halving(const CVertexGraph& graph, const CoveringOptions& options)
      : graph_(graph),
        events_(graph, options.event_persistence, options.first_stage),
        max_radius_(options.max_radius),
        bin_(graph.c_vertex_count(), 0),
        disks_of_(graph.c_vertex_count(), kNone),
        distance_(graph.c_vertex_count(), std::numeric_limits<float>::infinity()) {}

  DiskCovering cover(const RunControl& control);

 private:
  struct Reached {
    CVertexId id;
    float distance;
  };
  // One disk in the list of a c-vertex.
  struct Entry {
    DiskId disk;
    std::uint32_t next;
  };
  // The smallest and the largest of the disks that overlap a disk; kNone if no disk does. Ties go
  // to the earlier disk.
  struct OverlappingDisks {
    DiskId smallest = kNone, largest = kNone;
  };

  float radius(int i) const { return std::ldexp(max_radius_, -i); }
  bool is_forbidden(CVertexId v) const { return disks_of_[v] != kNone; }
  std::uint64_t bin_key(CVertexId v) const;

  void place_disk(CVertexId v);
  void enforce_radius_constraints(DiskId first);
  void halve(DiskId disk);
  OverlappingDisks find_overlapping(DiskId disk);
  void grow(CVertexId centre, float radius);
  void move_to_bin(CVertexId v, int i);
  void forbid(CVertexId v, DiskId disk);
  void unforbid(CVertexId v, DiskId disk);

  const CVertexGraph& graph_;
  EventFinder events_;
  float max_radius_;
  std::vector<CVertexId> site_;          // per disk
  std::vector<std::uint16_t> halvings_;  // per disk, the i of R_g / 2^i
  std::vector<std::uint16_t>
      bin_;  // per c-vertex, the largest i it was assigned, even while it is forbidden
  KeyHeap<std::greater<>>
      bins_;  // see bin_key(); entries that are out of date are dropped when popped
  std::vector<std::uint32_t>
      disks_of_;  // per c-vertex, the first entry of its list; kNone: in no disk, so not forbidden
  std::vector<Entry> entries_;
  std::uint32_t unused_ = kNone;  // first of the list of free entries
  std::size_t forbidden_ = 0;     // number of forbidden c-vertices

  std::vector<float> distance_;  // infinite except for the c-vertices of ball_
  std::vector<Reached> ball_;    // result of grow(), nearest first
  NearestFirst front_;
  std::vector<DiskId> to_check_;
};

// Orders by bin, then boundary before interior c-vertices, then by id.
std::uint64_t Halving::bin_key(CVertexId v) const {
  return static_cast<std::uint64_t>(bin_[v]) << 33 |
         static_cast<std::uint64_t>(graph_.on_boundary[v] ? 0 : 1) << 32 | v;
}

// Figure 3.
DiskCovering Halving::cover(const RunControl& control) {
  for (CVertexId v = 0; v < graph_.c_vertex_count(); ++v) bins_.push(bin_key(v));
  std::size_t most_forbidden = 0;  // halving lowers the count, but progress must not fall
  while (!bins_.empty()) {
    const std::uint64_t key = bins_.pop();
    const CVertexId v = key_id(key);
    if (is_forbidden(v) || key != bin_key(v)) continue;
    control.check_cancelled();
    most_forbidden = std::max(most_forbidden, forbidden_);
    if (site_.size() % 64 == 0)
      control.report("cover", static_cast<double>(most_forbidden) / graph_.c_vertex_count());
    place_disk(v);
    enforce_radius_constraints(static_cast<DiskId>(site_.size() - 1));
  }
  DiskCovering out;
  out.sites = site_;
  out.radii.reserve(site_.size());
  for (const std::uint16_t i : halvings_) out.radii.push_back(radius(i));
  return out;
}

// Adds a disk as large as its bin, topological events and the smaller disks it overlaps allow, and
// applies figure 5 for every radius it had in between.
void Halving::place_disk(CVertexId v) {
  int first = bin_[v];
  const float event = events_.event_radius(v, radius(first));
  while (radius(first) > event) ++first;

  // Halving for smaller disks only considers the inside of the disk, and keeps what lies between
  // two radii.
  grow(v, 3 * radius(first));
  int last = first;
  for (const Reached& x : ball_) {
    if (x.distance >= radius(last)) break;
    for (std::uint32_t e = disks_of_[x.id]; e != kNone; e = entries_[e].next) {
      while (halvings_[entries_[e].disk] > last + 1 && x.distance < radius(last)) ++last;
    }
  }

  const DiskId disk = static_cast<DiskId>(site_.size());
  site_.push_back(v);
  halvings_.push_back(static_cast<std::uint16_t>(last));
  int i = last;
  for (const Reached& x : ball_) {
    if (x.distance < radius(last)) {
      forbid(x.id, disk);
      continue;
    }
    while (x.distance >= 2 * radius(i))
      --i;  // ends at first - 1, since x is nearer than 3 R_g / 2^first
    move_to_bin(x.id, i);
  }
}

// Figure 7, with a stack instead of recursion: the last disk is checked until it is right, then the
// previous one is checked again. This ends: a disk is halved only while it is more than twice as
// large as another one, so none gets smaller than the first one.
void Halving::enforce_radius_constraints(DiskId first) {
  to_check_.assign(1, first);
  while (!to_check_.empty()) {
    const DiskId disk = to_check_.back();
    const OverlappingDisks overlapping = find_overlapping(disk);
    if (overlapping.smallest != kNone && halvings_[overlapping.smallest] > halvings_[disk] + 1) {
      halve(disk);
    } else if (overlapping.largest != kNone &&
               halvings_[overlapping.largest] + 1 < halvings_[disk]) {
      halve(overlapping.largest);
      to_check_.push_back(overlapping.largest);
    } else {
      to_check_.pop_back();
    }
  }
}

void Halving::halve(DiskId disk) {
  const float before = radius(halvings_[disk]), now = radius(++halvings_[disk]);
  grow(site_[disk], before);
  for (const Reached& x : ball_) {
    if (x.distance < now) continue;
    unforbid(x.id, disk);
    bin_[x.id] = std::max(bin_[x.id], halvings_[disk]);
    if (!is_forbidden(x.id)) bins_.push(bin_key(x.id));
  }
}

Halving::OverlappingDisks Halving::find_overlapping(DiskId disk) {
  const auto is_smaller = [&](DiskId a, DiskId b) {
    return halvings_[a] != halvings_[b] ? halvings_[a] > halvings_[b] : a < b;
  };
  const auto is_larger = [&](DiskId a, DiskId b) {
    return halvings_[a] != halvings_[b] ? halvings_[a] < halvings_[b] : a < b;
  };
  OverlappingDisks out;
  grow(site_[disk], radius(halvings_[disk]));
  for (const Reached& x : ball_) {
    for (std::uint32_t e = disks_of_[x.id]; e != kNone; e = entries_[e].next) {
      const DiskId other = entries_[e].disk;
      if (other == disk) continue;
      if (out.smallest == kNone || is_smaller(other, out.smallest)) out.smallest = other;
      if (out.largest == kNone || is_larger(other, out.largest)) out.largest = other;
    }
  }
  return out;
}

// Stores the disk D_centre^radius in ball_.
void Halving::grow(CVertexId centre, float radius) {
  for (const Reached& x : ball_) distance_[x.id] = std::numeric_limits<float>::infinity();
  ball_.clear();
  distance_[centre] = 0;
  front_.push(length_key(0, centre));
  while (!front_.empty()) {
    const std::uint64_t key = front_.pop();
    const CVertexId w = key_id(key);
    if (key_length(key) > distance_[w]) continue;
    ball_.push_back({w, distance_[w]});
    for (const CVertexGraph::Neighbour& n : graph_.row(w)) {
      const float d = distance_[w] + n.weight;
      if (d >= radius || d >= distance_[n.id]) continue;
      distance_[n.id] = d;
      front_.push(length_key(d, n.id));
    }
  }
}

void Halving::move_to_bin(CVertexId v, int i) {
  if (i <= bin_[v]) return;
  bin_[v] = static_cast<std::uint16_t>(i);
  if (!is_forbidden(v)) bins_.push(bin_key(v));
}

void Halving::forbid(CVertexId v, DiskId disk) {
  forbidden_ += !is_forbidden(v);
  if (unused_ == kNone) {
    unused_ = static_cast<std::uint32_t>(entries_.size());
    entries_.push_back({kNone, kNone});
  }
  const std::uint32_t e = unused_;
  unused_ = entries_[e].next;
  entries_[e] = {disk, disks_of_[v]};
  disks_of_[v] = e;
}

void Halving::unforbid(CVertexId v, DiskId disk) {
  std::uint32_t* at = &disks_of_[v];
  while (entries_[*at].disk != disk) at = &entries_[*at].next;
  const std::uint32_t e = *at;
  *at = entries_[e].next;
  entries_[e].next = unused_;
  unused_ = e;
  forbidden_ -= !is_forbidden(v);
}

}  // namespace

DiskCovering cover_by_halving(const CVertexGraph& graph, const CoveringOptions& options,
                              const RunControl& control) {
  return Halving(graph, options).cover(control);
}

void cover_from(const DiskCovering& disks, const CVertexGraph& graph, Covering& covering,
                const RunControl& control) {
  std::vector<Covering::Radius> radii;
  radii.reserve(disks.sites.size());
  for (std::size_t k = 0; k < disks.sites.size(); ++k)
    radii.push_back({disks.sites[k], disks.radii[k]});
  covering.seed(disks.sites, radii, control);

  const Partition& partition = covering.partition();
  for (bool again = true; again;) {  // ends: whatever is uncovered here adds a site
    covering.cover(control);
    again = false;
    for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
      if (!graph.on_boundary[v] || graph.on_boundary[partition.site[partition.cell_of[v]]])
        continue;
      covering.lower_radius(v, covering.distance()[v]);
      again = true;
    }
  }
}

}  // namespace isoatlas::detail
