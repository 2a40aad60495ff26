// SPDX-License-Identifier: Apache-2.0
#include "simplify/remove_vertices.h"

#include <algorithm>

#include "core/epoch_set.h"
#include "core/parallel.h"
#include "core/ranges.h"
#include "core/require.h"
#include "core/sort_once.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kVerticesPerChunk = 64;
constexpr std::size_t kTestsPerChunk = 16;  // of grid cells or triangles
constexpr std::size_t kMaxTargets = 3;      // that are tried until the triangles of a vertex change

}  // namespace

std::vector<Collapse> VertexRemoval::remove(std::span<const std::uint32_t> candidates,
                                            NearbyIsosurface* isosurface) {
  candidates_.clear();
  for (const std::uint32_t v : candidates) candidates_.push_back({v, {}, {}});
  std::vector<Collapse> kept;
  std::vector<std::uint32_t> to_plan(candidates.size()), active;
  for (std::uint32_t i = 0; i < to_plan.size(); ++i) to_plan[i] = i;
  while (!to_plan.empty() || !active.empty()) {
    control_.check_cancelled();
    plan(to_plan, isosurface);
    active.insert(active.end(), to_plan.begin(), to_plan.end());
    sort_unique_ids(active);
    std::erase_if(active,
                  [&](std::uint32_t i) { return candidates_[i].planned.collapse.target == kNone; });
    ranges::stable_sort(active, std::less<>(),
                        [&](std::uint32_t i) { return candidates_[i].planned.cost; });
    std::vector<Applied> applied = apply(active);
    test(applied, isosurface);
    to_plan = next_to_plan(applied);
    for (const Applied& it : applied) {
      if (it.state == State::kept) kept.push_back(it.collapse);
    }
  }
  return kept;
}

bool VertexRemoval::may_change(std::uint32_t vertex, const NearbyIsosurface* isosurface) const {
  return isosurface == nullptr || ranges::none_of(mesh_.star(vertex), [&](std::uint32_t t) {
           return isosurface->is_fixed(t);
         });
}

void VertexRemoval::plan(std::span<const std::uint32_t> numbers,
                         const NearbyIsosurface* isosurface) {
  for_each_chunk(numbers.size(), kVerticesPerChunk, [&](std::size_t begin, std::size_t end) {
    control_.check_cancelled();
    CollapsePlanner planner(mesh_, box_, limits_);
    for (const std::uint32_t i : numbers.subspan(begin, end - begin)) {
      Candidate& candidate = candidates_[i];
      const bool is_possible =
          candidate.excluded.size() < kMaxTargets && may_change(candidate.vertex, isosurface);
      candidate.planned =
          is_possible ? planner.plan(candidate.vertex, candidate.excluded) : PlannedCollapse();
    }
  });
}

// Applies planned collapses that change no triangle of another one.
std::vector<VertexRemoval::Applied> VertexRemoval::apply(std::span<const std::uint32_t> active) {
  std::vector<Applied> out;
  EpochSet is_changed;
  changed_by_.clear();
  outdated_.clear();
  CollapsePlanner planner(mesh_, box_, limits_);
  for (const std::uint32_t i : active) {
    Candidate& candidate = candidates_[i];
    const Collapse collapse = candidate.planned.collapse;
    if (ranges::any_of(mesh_.star(collapse.vertex),
                       [&](std::uint32_t t) { return is_changed.contains(t); }))
      continue;
    if (!planner.is_possible(collapse)) {
      outdated_.push_back(i);
      continue;
    }
    Applied& it = out.emplace_back(Applied{i, collapse, mesh_.apply(collapse)});
    for (const auto& [t, before] : it.changed) {
      is_changed.insert(t);
      changed_by_.emplace_back(t, static_cast<std::uint32_t>(out.size() - 1));
    }
  }
  ranges::sort(changed_by_);
  return out;
}

std::uint32_t VertexRemoval::changed_by(std::uint32_t triangle) const {
  const auto found =
      ranges::lower_bound(changed_by_, triangle, {}, [](const auto& entry) { return entry.first; });
  return found != changed_by_.end() && found->first == triangle ? found->second : kNone;
}

void VertexRemoval::fail(std::vector<Applied>& applied, std::uint32_t triangle) const {
  const std::uint32_t by = changed_by(triangle);
  if (by != kNone && applied[by].state == State::kept) applied[by].state = State::failed;
}

// Reverts collapses until all limits are satisfied.
void VertexRemoval::test(std::vector<Applied>& applied, NearbyIsosurface* isosurface) {
  std::vector<std::uint32_t> changed;  // since the last test of distances
  for (const auto& entry : changed_by_) changed.push_back(entry.first);
  std::vector<std::uint32_t> untracked = changed;
  NewProofs proofs;
  if (isosurface != nullptr) {
    proofs.cells = isosurface->cells_that_need(changed);
    proofs.proof.resize(proofs.cells.size());
    test_triangles(applied, *isosurface);
  }
  while (!changed.empty()) {
    if (isosurface != nullptr) test_distances(applied, changed, *isosurface, proofs);
    changed = revert_failed(applied);
    if (!changed.empty()) continue;
    test_intersections(applied, untracked);
    changed = untracked = revert_failed(applied);
  }
  for (std::size_t i = 0; i < proofs.cells.size(); ++i)
    isosurface->set_proof(proofs.cells[i], std::move(proofs.proof[i]));
}

void VertexRemoval::test_triangles(std::vector<Applied>& applied,
                                   const NearbyIsosurface& isosurface) const {
  for_each_index(applied.size(), kTestsPerChunk, &control_, [&](std::size_t i) {
    const bool all_near = ranges::all_of(applied[i].changed, [&](const ChangedTriangle& it) {
      return CollapsingMesh::is_removed(mesh_.triangle(it.first)) || isosurface.is_near(it.first);
    });
    if (!all_near) applied[i].state = State::failed;
  });
}

void VertexRemoval::test_distances(std::vector<Applied>& applied,
                                   std::span<const std::uint32_t> changed,
                                   const NearbyIsosurface& isosurface, NewProofs& proofs) const {
  const std::vector<std::uint32_t> cells = isosurface.cells_that_need(changed);
  std::vector<std::uint8_t> has_failed(cells.size(), 0);
  for_each_index(cells.size(), kTestsPerChunk, &control_, [&](std::size_t i) {
    const std::span<const std::uint32_t> before = isosurface.triangles_of(cells[i]);
    std::vector<std::uint32_t> triangles(before.begin(), before.end());
    for (const std::uint32_t t : before) {
      const std::uint32_t by = changed_by(t);
      if (by == kNone) continue;
      for (const ChangedTriangle& it : applied[by].changed) triangles.push_back(it.first);
    }
    sort_unique_ids(triangles);
    const auto at = static_cast<std::size_t>(ranges::lower_bound(proofs.cells, cells[i]) -
                                             proofs.cells.begin());
    has_failed[i] = isosurface.prove(cells[i], triangles, proofs.proof[at]) ? 0 : 1;
  });
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (has_failed[i] == 0) continue;
    for (const std::uint32_t t : isosurface.triangles_of(cells[i])) fail(applied, t);
  }
}

// @param changed  triangles that the tracker does not know yet, sorted
void VertexRemoval::test_intersections(std::vector<Applied>& applied,
                                       std::span<const std::uint32_t> changed) {
  if (changed.empty()) return;
  std::vector<Triangle> corners;
  for (const std::uint32_t t : changed) corners.push_back(mesh_.triangle(t));
  tracker_.update({}, {}, changed, corners, control_);
  for (const auto& [a, b] : tracker_.pairs()) {
    fail(applied, a);
    fail(applied, b);
  }
}

// @return the triangles that are as before again, sorted
std::vector<std::uint32_t> VertexRemoval::revert_failed(std::vector<Applied>& applied) {
  std::vector<std::uint32_t> out;
  for (Applied& it : applied) {
    if (it.state != State::failed) continue;
    mesh_.revert(it.collapse, it.changed);
    it.state = State::reverted;
    for (const ChangedTriangle& changed : it.changed) out.push_back(changed.first);
  }
  ranges::sort(out);
  return out;
}

// The candidates whose triangles have changed, or whose collapse has failed or is outdated.
std::vector<std::uint32_t> VertexRemoval::next_to_plan(std::span<const Applied> applied) {
  std::vector<std::uint32_t> out = outdated_, changed;
  for (const Applied& it : applied) {
    Candidate& candidate = candidates_[it.candidate];
    candidate.planned = {};
    if (it.state != State::kept) {
      candidate.excluded.push_back(it.collapse.target);
      out.push_back(it.candidate);
      continue;
    }
    for (const auto& [t, before] : it.changed)
      changed.insert(changed.end(), before.begin(), before.end());
  }
  sort_unique_ids(changed);
  for (const std::uint32_t v : changed) {
    const auto found = ranges::lower_bound(candidates_, v, {}, &Candidate::vertex);
    if (found == candidates_.end() || found->vertex != v || mesh_.star(v).empty()) continue;
    found->excluded.clear();
    out.push_back(static_cast<std::uint32_t>(found - candidates_.begin()));
  }
  sort_unique_ids(out);
  return out;
}

}  // namespace isoatlas::detail
