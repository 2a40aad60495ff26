// SPDX-License-Identifier: Apache-2.0
#include "optimize/shape_optimizer.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "core/cancel_poll.h"
#include "core/epoch_set.h"
#include "core/parallel.h"
#include "core/ranges.h"
#include "core/sort_once.h"
#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "optimize/mesh_editor.h"
#include "optimize/relax.h"
#include "optimize/shape_change.h"

namespace isoatlas::detail {
namespace {

constexpr int kPasses = 24;
constexpr std::size_t kMinKeptDivisor =
    10;  // passes that reduce errors end once fewer than one change in so many is kept
constexpr double kMinGain = 1e-3;
constexpr std::size_t kPerChunk = 4096;  // triangles, of a parallel loop
constexpr std::size_t kBatch =
    64;  // changes that are searched for before the first of them is applied
constexpr int kRelaxRounds = 3;
constexpr int kMaxReverts =
    4;  // rounds of reverting cells that violate their bounds because of relaxation

std::vector<CellId> all_cells(const MeasuredCovering& measured) {
  std::vector<CellId> out(measured.mesh().cell_count());
  std::iota(out.begin(), out.end(), 0u);
  return out;
}

std::vector<double> excess_of_each(const MeasuredCovering& measured,
                                   std::span<const CellId> cells) {
  std::vector<double> out;
  out.reserve(cells.size());
  for (const CellId c : cells) out.push_back(measured.errors()[c].excess);
  return out;
}

// Whether a cell's excess has increased and violates a bound.
bool is_worse(double after, double before) {
  return after > std::max(1.0, before * (1 + kMinGain));
}

// Improves a mesh in passes; each pass makes changes that are far from each other.
class ShapeOptimizer {
 public:
  // The purpose of a change: the shape of a triangle, or the error of a cell that violates its
  // bounds.
  enum class Purpose { shape, errors };

  /// @param tracker  if given, no change is kept that makes triangles intersect, and fixed vertices
  ///                 and edges may change as well; none: intersections are not tested
  ShapeOptimizer(MeasuredCovering& measured, const ShapeGoal& goal,
                 std::vector<DualTriangle>& triangles, const RunControl& control,
                 IntersectionTracker* tracker = nullptr)
      : mesh_(measured, triangles, tracker, control),
        changes_(mesh_, goal, tracker != nullptr),
        goal_(goal),
        control_(control),
        avoids_intersections_(tracker != nullptr) {}

  void run(Purpose purpose, std::span<const CellId> cells, ShapeReport& report) {
    for (int k = 0; k < kPasses; ++k) {
      report_continuing(control_);
      const std::size_t kept_before = report.flips + report.moves;
      const std::size_t tried = pass(purpose, cells, report);
      const std::size_t kept = report.flips + report.moves - kept_before;
      if (tried == 0 || (purpose == Purpose::errors && kept * kMinKeptDivisor < tried)) break;
    }
    report.bad = bad_triangles().size();
  }

  // Displaces vertices without fixed anchors. Where a cell violates its bounds because of that,
  // they are reverted. @return false if none moved
  bool relax_bad_triangles(ShapeReport& report) {
    const std::vector<Vec3> from = mesh_.mesh().point;
    std::vector<Vec3> points = from;
    const std::vector<CellId> moved = relax_points(points);
    if (moved.empty()) return false;
    report_continuing(control_);
    std::vector<Vec3> old_displacement;
    for (const CellId c : moved) {
      old_displacement.push_back(displacement_of(c));
      mesh_.displace(c, old_displacement.back() + (points[c] - from[c]));
    }
    const auto old_displacement_of = [&](CellId c) {
      return old_displacement[static_cast<std::size_t>(ranges::lower_bound(moved, c) -
                                                       moved.begin())];
    };
    mark_reverted(mesh_.revert_conflicting_moves(moved, old_displacement));
    const std::vector<CellError> before = mesh_.measured().errors();
    std::vector<CellId> affected = mesh_.affected_by(moved);
    mesh_.measure(affected);
    const int max_rounds = avoids_intersections_ ? kMaxReverts + 1 : kMaxReverts;
    for (int round = 0; round < max_rounds; ++round) {
      report_continuing(control_);
      std::vector<CellId> worse = mesh_.intersecting_corners();
      ranges::copy_if(affected, std::back_inserter(worse),
                      [&](CellId c) { return is_worse(mesh_.excess(c), before[c].excess); });
      if (worse.empty()) break;
      // The last rounds revert everything in the affected ring and, if triangles must not
      // intersect, everything.
      worse = round >= kMaxReverts      ? moved
              : round + 1 < kMaxReverts ? mesh_.k_ring(worse, 1)
                                        : mesh_.affected_by(worse);
      for (const CellId c : worse) {
        if (ranges::binary_search(moved, c)) mesh_.displace(c, old_displacement_of(c));
      }
      mark_reverted(worse);
      const std::vector<CellId> conflicting =
          mesh_.revert_conflicting_moves(moved, old_displacement);
      mark_reverted(conflicting);
      worse.insert(worse.end(), conflicting.begin(), conflicting.end());
      affected = mesh_.affected_by(worse);
      mesh_.measure(affected);
    }
    for (std::size_t i = 0; i < moved.size(); ++i)
      report.displacements += !(displacement_of(moved[i]) == old_displacement[i]);
    return true;
  }

 private:
  Vec3 displacement_of(CellId c) const {
    return mesh_.placement().displacement.empty() ? Vec3{} : mesh_.placement().displacement[c];
  }

  // Marks cells whose vertices are not displaced again.
  void mark_reverted(std::span<const CellId> cells) {
    for (const CellId c : cells) reverted_.insert(c);
  }

  // Relaxes the points of vertices. @return those that moved, sorted
  std::vector<CellId> relax_points(std::vector<Vec3>& points) {
    const SurfaceData& surface_data = mesh_.surface_data();
    const LevelMesh& mesh = mesh_.mesh();
    const VertexPlacement& placement = mesh_.placement();
    const auto bounds_of = [&](CellId c) -> MoveBounds {
      const CVertexId v = placement.anchor[c];
      const Vec3 p = mesh.point[c];
      if (mesh_.measured().has_fixed_anchor(c) || !changes_.is_movable(c) ||
          reverted_.contains(c) || !surface_data.is_movable(v))
        return {p, p};
      const Vec3 balanced = p - placement.base_point(surface_data.surfels, c);
      const MoveBounds at =
          move_bounds_of(surface_data.complex.positions[v], surface_data.complex.spacing);
      return {at.low + balanced, at.high + balanced};
    };
    const InterpolatedField* field =
        surface_data.isosurface == nullptr ? nullptr : &surface_data.isosurface->field();
    std::vector<std::uint32_t> bad = bad_triangles();
    ranges::sort(bad);
    return relax(points, mesh.triangles, mesh.triangles_of, bounds_of, field,
                 surface_data.complex.spacing, {goal_.aspect, 0}, control_, bad);
  }

  // Sorted by score, the worst first.
  std::vector<std::uint32_t> bad_triangles() {
    std::vector<std::uint32_t> changed = mesh_.take_changed_triangles();
    if (!std::exchange(is_scored_, true)) {
      changed.resize(mesh_.mesh().triangles.size());
      std::iota(changed.begin(), changed.end(), 0u);
    } else {
      std::erase_if(
          bad_, [&](const auto& scored) { return ranges::binary_search(changed, scored.second); });
    }
    using Scored = std::pair<double, std::uint32_t>;
    const auto found = collect_chunks<Scored>(
        changed.size(), kPerChunk,
        [&](std::size_t begin, std::size_t end, std::vector<Scored>& out) {
          control_.check_cancelled();
          for (const std::uint32_t t : std::span(changed).subspan(begin, end - begin)) {
            const double score = changes_.score(t);
            if (score < 1 && !changes_.is_at_shared_face(t)) out.emplace_back(score, t);
          }
        });
    control_.check_cancelled();
    bad_.insert(bad_.end(), found.begin(), found.end());
    std::sort(bad_.begin(), bad_.end());
    std::vector<std::uint32_t> out;
    for (const auto& [score, t] : bad_) out.push_back(t);
    return out;
  }

  // Returns the cells that violate their bounds, the worst first.
  std::vector<CellId> violating_cells(std::span<const CellId> cells) const {
    std::vector<std::pair<double, CellId>> found;
    for (const CellId c : cells) {
      if (mesh_.excess(c) > 1) found.emplace_back(-mesh_.excess(c), c);
    }
    std::sort(found.begin(), found.end());
    std::vector<CellId> out;
    for (const auto& [excess, c] : found) out.push_back(c);
    return out;
  }

  // A change that is tried.
  struct Trial {
    ShapeChange change;
    std::vector<CellId> affected;
    std::vector<double> excess_before;  // per affected cell
    // The state to return to.
    DualTriangle old_first, old_second;
    CVertexId old_anchor = kNone;
    Vec3 old_displacement{};
    bool is_kept = true;
  };

  // Tries one change for every badly shaped triangle, or for every cell to repair that violates its
  // bounds, where there is one that is far from the other changes. @return number of changes tried
  std::size_t pass(Purpose purpose, std::span<const CellId> cells_to_repair, ShapeReport& report) {
    std::vector<Trial> trials =
        purpose == Purpose::errors ? trials_at(cells_to_repair) : trials_at_bad_triangles();
    if (trials.empty()) return 0;
    control_.check_cancelled();
    std::vector<CellId> cells;
    for (Trial& trial : trials) {
      cells.insert(cells.end(), trial.affected.begin(), trial.affected.end());
      apply(trial);
    }
    std::sort(cells.begin(), cells.end());
    mesh_.measure(cells);
    std::vector<CellId> stale;  // affected by reverted changes
    for (Trial& trial : trials) {
      if (!is_better(trial, purpose)) revert(trial, stale);
    }
    measure_again(stale);
    for (std::vector<CellId> corners = mesh_.intersecting_corners(); !corners.empty();
         corners = mesh_.intersecting_corners()) {
      const auto is_corner = [&](CellId c) { return ranges::binary_search(corners, c); };
      for (Trial& trial : trials) {
        if (trial.is_kept && ranges::any_of(trial.affected, is_corner)) revert(trial, stale);
      }
      if (stale.empty()) break;
      measure_again(stale);
    }
    for (const Trial& trial : trials) {
      if (trial.is_kept) ++(trial.change.is_flip() ? report.flips : report.moves);
    }
    changes_.sort_rejected();
    return trials.size();
  }

  std::vector<Trial> trials_at_bad_triangles() {
    std::vector<Trial> out;
    taken_.clear();
    const auto is_taken = [&](std::uint32_t t) {
      return ranges::any_of(mesh_.mesh().triangles[t],
                            [&](CellId c) { return taken_.contains(c); });
    };
    std::vector<std::uint32_t> next;
    const auto try_next = [&] {
      const std::vector<ShapeChange> best = best_changes(next);
      for (std::size_t k = 0; k < next.size(); ++k) {
        if (!is_taken(next[k])) add_trial(best[k], next[k], out);
      }
      next.clear();
    };
    for (const std::uint32_t t : bad_triangles()) {
      if (is_taken(t)) continue;  // the most frequent case
      next.push_back(t);
      if (next.size() == kBatch) try_next();
    }
    try_next();
    return out;
  }

  // Per triangle, the change that improves it most.
  std::vector<ShapeChange> best_changes(std::span<const std::uint32_t> triangles) const {
    control_.check_cancelled();
    std::vector<ShapeChange> best(triangles.size());
    for_each_index(triangles.size(), 1, [&](std::size_t k) {
      changes_.find_best_flip(triangles[k], kMinGain, best[k]);
      for (const CellId c : mesh_.mesh().triangles[triangles[k]])
        changes_.find_best_move(c, kMinGain, best[k]);
    });
    return best;
  }

  std::vector<Trial> trials_at(std::span<const CellId> cells) {
    std::vector<Trial> out;
    taken_.clear();
    const LevelMesh& mesh = mesh_.mesh();
    CancelPoll poll(control_);
    for (const CellId c : violating_cells(cells)) {
      poll.step();
      if (taken_.contains(c)) continue;
      ShapeChange best;
      for (const std::uint32_t t : mesh.triangles_of.row(c))
        changes_.find_best_flip(t, std::nullopt, best);
      changes_.find_best_move(c, std::nullopt, best);
      add_trial(best, best.is_flip() ? best.i : mesh.triangles_of.row(c)[0], out);
    }
    return out;
  }

  // Adds a trial unless it affects a cell that another trial affects.
  void add_trial(const ShapeChange& change, std::uint32_t triangle, std::vector<Trial>& out) {
    if (change.score == 0) return;
    std::vector<CellId> affected = mesh_.affected_by(mesh_.mesh().triangles[triangle]);
    if (ranges::any_of(affected, [&](CellId c) { return taken_.contains(c); })) return;
    for (const CellId c : affected) taken_.insert(c);
    std::vector<double> before = excess_of_each(mesh_.measured(), affected);
    out.push_back({change, std::move(affected), std::move(before), {}, {}});
  }

  void apply(Trial& trial) {
    const ShapeChange& c = trial.change;
    if (c.is_flip()) {
      trial.old_first = mesh_.triangle(c.i);
      trial.old_second = mesh_.triangle(c.j);
      mesh_.set_triangle(c.i, c.first);
      mesh_.set_triangle(c.j, c.second);
    } else {
      trial.old_anchor = mesh_.placement().anchor[c.cell];
      trial.old_displacement = displacement_of(c.cell);
      mesh_.move(c.cell, c.to, {});
    }
  }

  void revert(Trial& trial, std::vector<CellId>& stale) {
    const ShapeChange& c = trial.change;
    trial.is_kept = false;
    stale.insert(stale.end(), trial.affected.begin(), trial.affected.end());
    changes_.reject(c);
    if (c.is_flip()) {
      mesh_.set_triangle(c.i, trial.old_first);
      mesh_.set_triangle(c.j, trial.old_second);
    } else {
      mesh_.move(c.cell, trial.old_anchor, trial.old_displacement);
    }
  }

  bool is_better(const Trial& trial, Purpose purpose) const {
    double max_before = 0, max_after = 0;
    for (std::size_t i = 0; i < trial.affected.size(); ++i) {
      const double before = trial.excess_before[i], after = mesh_.excess(trial.affected[i]);
      if (is_worse(after, before)) return false;
      max_before = std::max(max_before, before);
      max_after = std::max(max_after, after);
    }
    return purpose != Purpose::errors || max_after <= max_before * (1 - kMinGain);
  }

  void measure_again(std::vector<CellId>& stale) {
    std::sort(stale.begin(), stale.end());
    if (!stale.empty()) mesh_.measure(stale);
    stale.clear();
  }

  MeshEditor mesh_;
  ShapeChanges changes_;
  const ShapeGoal& goal_;
  const RunControl& control_;
  bool avoids_intersections_;
  bool is_scored_ = false;
  // badly shaped triangles with their scores, except those that have changed since; sorted
  std::vector<std::pair<double, std::uint32_t>> bad_;
  EpochSet reverted_;  // cells whose vertices were reverted
  EpochSet taken_;     // cells that are affected by a change of this pass
};

// Reverts changes, and further ones where a cell would violate its bounds because of that.
class ChangeReverter {
 public:
  ChangeReverter(MeasuredCovering& measured, std::vector<DualTriangle>& triangles,
                 IntersectionTracker* tracker, const RunControl& control)
      : mesh_(measured, triangles, tracker, control), control_(control) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      if (triangles[t].cell != measured.triangles()[t].cell) flipped_.push_back(t);
    }
  }

  MeshEditor& mesh() { return mesh_; }

  // Reverts flips around these cells, and moves where there are no flips, and repeats this around
  // cells with a larger excess than before or than `permitted`.
  // @return whether anything was reverted
  bool revert(std::vector<CellId> cells, double permitted = INFINITY) {
    std::vector<double> before;
    for (const CellError& e : mesh_.measured().errors())
      before.push_back(std::min(e.excess, permitted));
    bool any = false;
    for (int round = 0; !cells.empty(); ++round) {
      report_continuing(control_);
      const std::vector<CellId> at_flips = revert_flips(cells);
      std::vector<CellId> changed = at_flips;
      for (const CellId c : cells) {
        if (fixed(c) == 1 && ranges::binary_search(at_flips, c)) continue;
        const bool was_fixed = fixed(c) == 3;
        mesh_.fix(c, 3);
        if (return_to_site(c) || !was_fixed) changed.push_back(c);
      }
      if (changed.empty()) break;
      any = true;
      const std::vector<CellId> affected = mesh_.affected_by(changed);
      mesh_.measure(affected);
      std::vector<CellId> worse;
      ranges::copy_if(affected, std::back_inserter(worse),
                      [&](CellId c) { return is_worse(mesh_.excess(c), before[c]); });
      cells = worse.empty()             ? worse
              : round + 1 < kMaxReverts ? mesh_.k_ring(worse, 1)
                                        : mesh_.affected_by(worse);
    }
    return any;
  }

  // Returns vertices without fixed anchors to their c-vertices where surfels of one grid cell
  // intersect at the current positions. @return whether any was returned
  bool revert_conflicting() {
    std::vector<CellId> displaced;
    for (CellId c = 0; c < mesh_.placement().displacement.size(); ++c) {
      if (!mesh_.measured().has_fixed_anchor(c) && !(mesh_.placement().displacement[c] == Vec3{}))
        displaced.push_back(c);
    }
    const std::vector<CellId> returned =
        mesh_.revert_conflicting_moves(displaced, std::vector<Vec3>(displaced.size()));
    if (!returned.empty()) mesh_.measure(mesh_.affected_by(returned));
    return !returned.empty();
  }

 private:
  std::uint8_t fixed(CellId c) const {
    const std::vector<std::uint8_t>& of = mesh_.placement().fixed;
    return c < of.size() ? of[c] : std::uint8_t{0};
  }

  // Replaces flipped triangles by the dual's; triangles with a common corner are replaced together.
  // @return their corners, sorted
  std::vector<CellId> revert_flips(std::span<const CellId> cells) {
    const std::vector<DualTriangle>& dual = mesh_.measured().triangles();
    near_.clear();
    for (const CellId c : cells) near_.insert(c);
    std::vector<CellId> changed;
    for (std::size_t before = kNone; before != flipped_.size();) {
      control_.check_cancelled();
      before = flipped_.size();
      std::erase_if(flipped_, [&](std::uint32_t t) {
        std::array<CellId, 6> corners;
        ranges::copy(dual[t].cell, ranges::copy(mesh_.triangle(t).cell, corners.begin()));
        if (ranges::none_of(corners, [&](CellId c) { return near_.contains(c); })) return false;
        for (const CellId c : corners) near_.insert(c);
        changed.insert(changed.end(), corners.begin(), corners.end());
        mesh_.set_triangle(t, dual[t]);
        return true;
      });
    }
    sort_unique_ids(changed);
    for (const CellId c : changed) mesh_.fix(c, 1);
    return changed;
  }

  // Returns a vertex without a fixed anchor to its site, unless another vertex is placed there.
  // @return whether it has moved
  bool return_to_site(CellId c) {
    if (mesh_.measured().has_fixed_anchor(c)) return false;
    const CVertexId site = mesh_.measured().partition().site[c],
                    anchor = mesh_.placement().anchor[c];
    const bool is_displaced =
        !mesh_.placement().displacement.empty() && !(mesh_.placement().displacement[c] == Vec3{});
    const bool moves = anchor != site && !mesh_.is_occupied(site);
    if (is_displaced || moves) mesh_.move(c, moves ? site : anchor, {});
    return is_displaced || moves;
  }

  MeshEditor mesh_;
  const RunControl& control_;
  std::vector<std::uint32_t> flipped_;  // triangles that differ from the dual
  EpochSet near_;                       // cells
};

}  // namespace

ShapeReport improve_shape(MeasuredCovering& measured, const ShapeGoal& goal,
                          std::vector<DualTriangle>& triangles, const RunControl& control) {
  ShapeReport report;
  triangles.assign(measured.triangles().begin(), measured.triangles().end());
  std::vector<CellId> violating;
  for (CellId c = 0; c < measured.errors().size(); ++c) {
    if (measured.errors()[c].excess > 1) violating.push_back(c);
  }
  measured.remesh(triangles, {}, violating);
  ShapeOptimizer optimizer(measured, goal, triangles, control);
  optimizer.run(ShapeOptimizer::Purpose::shape, {}, report);
  for (int round = 0;
       round < kRelaxRounds && report.bad > 0 && optimizer.relax_bad_triangles(report); ++round)
    optimizer.run(ShapeOptimizer::Purpose::shape, {}, report);
  return report;
}

void improve_shape_without_intersections(MeasuredCovering& measured, const ShapeGoal& goal,
                                         IntersectionTracker& tracker,
                                         std::vector<DualTriangle>& triangles, ShapeReport& report,
                                         const RunControl& control) {
  ShapeOptimizer optimizer(measured, goal, triangles, control, &tracker);
  for (int round = 0;
       round < kRelaxRounds && report.bad > 0 && optimizer.relax_bad_triangles(report); ++round)
    optimizer.run(ShapeOptimizer::Purpose::shape, {}, report);
}

void improve_errors(MeasuredCovering& measured, const ShapeGoal& goal,
                    std::span<const CellId> cells, std::vector<DualTriangle>& triangles,
                    ShapeReport& report, const RunControl& control) {
  ShapeOptimizer(measured, goal, triangles, control)
      .run(ShapeOptimizer::Purpose::errors, cells, report);
}

std::vector<CellId> revert_intersecting(MeasuredCovering& measured, IntersectionTracker& tracker,
                                        std::vector<DualTriangle>& triangles,
                                        const RunControl& control) {
  ChangeReverter changes(measured, triangles, &tracker, control);
  for (;;) {
    std::vector<CellId> corners = changes.mesh().intersecting_corners();
    if (corners.empty() || !changes.revert(corners)) return corners;
  }
}

bool revert_conflicting_moves(MeasuredCovering& measured, std::vector<DualTriangle>& triangles,
                              const RunControl& control) {
  return ChangeReverter(measured, triangles, nullptr, control).revert_conflicting();
}

bool revert_at(MeasuredCovering& measured, std::span<const CellId> cells,
               std::vector<DualTriangle>& triangles, const RunControl& control) {
  ChangeReverter changes(measured, triangles, nullptr, control);
  return changes.revert(changes.mesh().k_ring(cells, 1), 1);
}

void revert_all(MeasuredCovering& measured, std::vector<DualTriangle>& triangles,
                const RunControl& control) {
  ChangeReverter(measured, triangles, nullptr, control).revert(all_cells(measured));
}

}  // namespace isoatlas::detail
