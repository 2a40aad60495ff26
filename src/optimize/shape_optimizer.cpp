// SPDX-License-Identifier: Apache-2.0
#include "optimize/shape_optimizer.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

#include "core/cancel_poll.h"
#include "core/epoch_set.h"
#include "core/parallel.h"
#include "core/sort_once.h"
#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "optimize/mesh_editor.h"
#include "optimize/relax.h"
#include "optimize/shape_change.h"

namespace isoatlas::detail {
namespace {

constexpr int kPasses = 24;
constexpr std::size_t kFewKept = 10;  // no more passes for the sake of errors once fewer than one change in so many helps
constexpr double kWorthIt = 1e-3;
constexpr std::size_t kPerPiece = 4096;  // triangles, of a parallel loop
constexpr std::size_t kTogether = 64;    // changes that are looked for before the first of them is taken
constexpr int kRelaxRounds = 3;
constexpr int kLooksBack = 4;  // after relaxing, for cells that it took over their bounds

std::vector<CellId> all_cells(const MeasuredCovering& work) {
  std::vector<CellId> out(work.mesh().cell_count());
  std::iota(out.begin(), out.end(), 0u);
  return out;
}

std::vector<double> excess_of_each(const MeasuredCovering& work, std::span<const CellId> cells) {
  std::vector<double> out;
  out.reserve(cells.size());
  for (const CellId c : cells) out.push_back(work.errors()[c].excess);
  return out;
}

// A cell's excess is worse than before, and too much.
bool is_worse(double now, double before) { return now > std::max(1.0, before * (1 + kWorthIt)); }

// Improves a mesh in passes, each of changes that are far from each other.
class ShapeOptimizer {
 public:
  // What a change is for: a triangle's shape, or the errors of a cell that is over its bounds.
  enum class Purpose { shape, errors };

  /// @param meeting  careful: no change is kept that makes triangles intersect, and then also vertices and edges may change that were given
  ///                 up; none: whether they do is not looked at
  ShapeOptimizer(MeasuredCovering& work, const ShapeGoal& goal, std::vector<DualTriangle>& triangles, const RunControl& control,
                 IntersectionTracker* meeting = nullptr)
      : mesh_(work, triangles, meeting, control),
        changes_(mesh_, goal, meeting != nullptr),
        goal_(goal),
        control_(control),
        is_careful_(meeting != nullptr) {}

  void run(Purpose purpose, std::span<const CellId> cells, ShapeReport& report) {
    for (int k = 0; k < kPasses; ++k) {
      report_going_on(control_);
      const std::size_t kept_before = report.flips + report.moves;
      const std::size_t tried = pass(purpose, cells, report);
      const std::size_t kept = report.flips + report.moves - kept_before;
      if (tried == 0 || (purpose == Purpose::errors && kept * kFewKept < tried)) break;
    }
    report.bad = bad_triangles().size();
  }

  // Moves vertices that are not frozen a little. Where that takes a cell over its bounds they go back. @return false if none moved
  bool relax_bad(ShapeReport& report) {
    const std::vector<Vec3> from = mesh_.mesh().point;
    std::vector<Vec3> points = from;
    const std::vector<CellId> moved = relaxed(points);
    if (moved.empty()) return false;
    report_going_on(control_);
    std::vector<Vec3> old_shift;
    for (const CellId c : moved) {
      old_shift.push_back(shift_of(c));
      mesh_.shift(c, old_shift.back() + (points[c] - from[c]));
    }
    const auto old_shift_of = [&](CellId c) {
      return old_shift[static_cast<std::size_t>(std::ranges::lower_bound(moved, c) - moved.begin())];
    };
    hold(mesh_.keep_from_straying(moved, old_shift));
    const std::vector<CellError> before = mesh_.work().errors();
    std::vector<CellId> concerned = mesh_.concerned_by(moved);
    mesh_.measure(concerned);
    const int looks = is_careful_ ? kLooksBack + 1 : kLooksBack;
    for (int look = 0; look < looks; ++look) {
      report_going_on(control_);
      std::vector<CellId> worse = mesh_.meeting_corners();
      std::ranges::copy_if(concerned, std::back_inserter(worse), [&](CellId c) { return is_worse(mesh_.excess(c), before[c].excess); });
      if (worse.empty()) break;
      // At last everything around goes back, and if triangles must not intersect, everything.
      worse = look >= kLooksBack ? moved : look + 1 < kLooksBack ? mesh_.around(worse, 1) : mesh_.concerned_by(worse);
      for (const CellId c : worse) {
        if (std::ranges::binary_search(moved, c)) mesh_.shift(c, old_shift_of(c));
      }
      hold(worse);
      const std::vector<CellId> strayed = mesh_.keep_from_straying(moved, old_shift);
      hold(strayed);
      worse.insert(worse.end(), strayed.begin(), strayed.end());
      concerned = mesh_.concerned_by(worse);
      mesh_.measure(concerned);
    }
    for (std::size_t i = 0; i < moved.size(); ++i) report.shifts += !(shift_of(moved[i]) == old_shift[i]);
    return true;
  }

 private:
  Vec3 shift_of(CellId c) const { return mesh_.placement().displacement.empty() ? Vec3{} : mesh_.placement().displacement[c]; }

  // Cells whose vertices are not moved again.
  void hold(std::span<const CellId> cells) {
    for (const CellId c : cells) held_.insert(c);
  }

  // Relaxes these points of vertices. @return those that moved, sorted
  std::vector<CellId> relaxed(std::vector<Vec3>& points) {
    const SurfaceData& surface_data = mesh_.surface_data();
    const LevelMesh& mesh = mesh_.mesh();
    const VertexPlacement& placement = mesh_.placement();
    const auto roam = [&](CellId c) -> Roam {
      const CVertexId v = placement.anchor[c];
      const Vec3 p = mesh.point[c];
      if (mesh_.work().has_fixed_anchor(c) || !changes_.is_movable(c) || held_.contains(c) || !surface_data.is_movable(v)) return {p, p};
      const Vec3 balanced = p - placement.base_point(surface_data.surfels, c);
      const Roam at = roam_of(surface_data.complex.positions[v], surface_data.complex.spacing);
      return {at.low + balanced, at.high + balanced};
    };
    const InterpolatedField* field = surface_data.isosurface == nullptr ? nullptr : &surface_data.isosurface->field();
    std::vector<std::uint32_t> bad = bad_triangles();
    std::ranges::sort(bad);
    return relax(points, mesh.triangles, mesh.triangles_of, roam, field, surface_data.complex.spacing, {goal_.aspect, 0}, control_, bad);
  }

  // The worst first.
  std::vector<std::uint32_t> bad_triangles() {
    std::vector<std::uint32_t> changed = mesh_.take_changed();
    if (!std::exchange(is_scored_, true)) {
      changed.resize(mesh_.mesh().triangles.size());
      std::iota(changed.begin(), changed.end(), 0u);
    } else {
      std::erase_if(bad_, [&](const auto& scored) { return std::ranges::binary_search(changed, scored.second); });
    }
    using Scored = std::pair<double, std::uint32_t>;
    const auto found = collect_pieces<Scored>(changed.size(), kPerPiece, [&](std::size_t begin, std::size_t end, std::vector<Scored>& out) {
      control_.check_cancelled();
      for (const std::uint32_t t : std::span(changed).subspan(begin, end - begin)) {
        const double score = changes_.score(t);
        if (score < 1) out.emplace_back(score, t);
      }
    });
    control_.check_cancelled();
    bad_.insert(bad_.end(), found.begin(), found.end());
    std::sort(bad_.begin(), bad_.end());
    std::vector<std::uint32_t> out;
    for (const auto& [score, t] : bad_) out.push_back(t);
    return out;
  }

  // Those of the cells that are over their bounds, the worst first.
  std::vector<CellId> over_bounds(std::span<const CellId> cells) const {
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
    std::vector<CellId> concerned;
    std::vector<double> excess_before;  // of these
    // What it changes.
    DualTriangle old_first, old_second;
    CVertexId old_anchor = kNone;
    Vec3 old_shift{};
    bool is_kept = true;
  };

  // One change for every bad triangle, or for every cell to mend that is over its bounds, that has one and is far from the others'.
  // @return how many were tried
  std::size_t pass(Purpose purpose, std::span<const CellId> cells_to_mend, ShapeReport& report) {
    std::vector<Trial> trials = purpose == Purpose::errors ? trials_at(cells_to_mend) : trials_at_bad_triangles();
    if (trials.empty()) return 0;
    control_.check_cancelled();
    std::vector<CellId> cells;
    for (Trial& trial : trials) {
      cells.insert(cells.end(), trial.concerned.begin(), trial.concerned.end());
      apply(trial);
    }
    std::sort(cells.begin(), cells.end());
    mesh_.measure(cells);
    std::vector<CellId> stale;  // around what was taken back
    for (Trial& trial : trials) {
      if (!is_better(trial, purpose)) take_back(trial, stale);
    }
    measure_again(stale);
    for (std::vector<CellId> corners = mesh_.meeting_corners(); !corners.empty(); corners = mesh_.meeting_corners()) {
      const auto is_corner = [&](CellId c) { return std::ranges::binary_search(corners, c); };
      for (Trial& trial : trials) {
        if (trial.is_kept && std::ranges::any_of(trial.concerned, is_corner)) take_back(trial, stale);
      }
      if (stale.empty()) break;
      measure_again(stale);
    }
    for (const Trial& trial : trials) {
      if (trial.is_kept) ++(trial.change.is_flip() ? report.flips : report.moves);
    }
    changes_.sort_refused();
    return trials.size();
  }

  std::vector<Trial> trials_at_bad_triangles() {
    std::vector<Trial> out;
    taken_.clear();
    const auto is_taken = [&](std::uint32_t t) {
      return std::ranges::any_of(mesh_.mesh().triangles[t], [&](CellId c) { return taken_.contains(c); });
    };
    std::vector<std::uint32_t> next;
    const auto take_next = [&] {
      const std::vector<ShapeChange> best = best_changes(next);
      for (std::size_t k = 0; k < next.size(); ++k) {
        if (!is_taken(next[k])) add_trial(best[k], next[k], out);
      }
      next.clear();
    };
    for (const std::uint32_t t : bad_triangles()) {
      if (is_taken(t)) continue;  // most end here
      next.push_back(t);
      if (next.size() == kTogether) take_next();
    }
    take_next();
    return out;
  }

  // Per triangle, the change that makes it better most.
  std::vector<ShapeChange> best_changes(std::span<const std::uint32_t> triangles) const {
    control_.check_cancelled();
    std::vector<ShapeChange> best(triangles.size());
    for_each_index(triangles.size(), 1, [&](std::size_t k) {
      changes_.consider_flips(triangles[k], kWorthIt, best[k]);
      for (const CellId c : mesh_.mesh().triangles[triangles[k]]) changes_.consider_moves(c, kWorthIt, best[k]);
    });
    return best;
  }

  std::vector<Trial> trials_at(std::span<const CellId> cells) {
    std::vector<Trial> out;
    taken_.clear();
    const LevelMesh& mesh = mesh_.mesh();
    CancelPoll poll(control_);
    for (const CellId c : over_bounds(cells)) {
      poll.step();
      if (taken_.contains(c)) continue;
      ShapeChange best;
      for (const std::uint32_t t : mesh.triangles_of.row(c)) changes_.consider_flips(t, std::nullopt, best);
      changes_.consider_moves(c, std::nullopt, best);
      add_trial(best, best.is_flip() ? best.i : mesh.triangles_of.row(c)[0], out);
    }
    return out;
  }

  // Unless it concerns a cell that another one does.
  void add_trial(const ShapeChange& change, std::uint32_t triangle, std::vector<Trial>& out) {
    if (change.score == 0) return;
    std::vector<CellId> near = mesh_.concerned_by(mesh_.mesh().triangles[triangle]);
    if (std::ranges::any_of(near, [&](CellId c) { return taken_.contains(c); })) return;
    for (const CellId c : near) taken_.insert(c);
    std::vector<double> before = excess_of_each(mesh_.work(), near);
    out.push_back({change, std::move(near), std::move(before), {}, {}});
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
      trial.old_shift = shift_of(c.cell);
      mesh_.move(c.cell, c.to, {});
    }
  }

  void take_back(Trial& trial, std::vector<CellId>& stale) {
    const ShapeChange& c = trial.change;
    trial.is_kept = false;
    stale.insert(stale.end(), trial.concerned.begin(), trial.concerned.end());
    changes_.refuse(c);
    if (c.is_flip()) {
      mesh_.set_triangle(c.i, trial.old_first);
      mesh_.set_triangle(c.j, trial.old_second);
    } else {
      mesh_.move(c.cell, trial.old_anchor, trial.old_shift);
    }
  }

  bool is_better(const Trial& trial, Purpose purpose) const {
    double most_before = 0, most_after = 0;
    for (std::size_t i = 0; i < trial.concerned.size(); ++i) {
      const double was = trial.excess_before[i], is = mesh_.excess(trial.concerned[i]);
      if (is_worse(is, was)) return false;
      most_before = std::max(most_before, was);
      most_after = std::max(most_after, is);
    }
    return purpose != Purpose::errors || most_after <= most_before * (1 - kWorthIt);
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
  bool is_careful_;
  bool is_scored_ = false;
  std::vector<std::pair<double, std::uint32_t>> bad_;  // of triangles, but for those that have changed since; sorted
  EpochSet held_;                                      // cells of which moving the vertex was taken back
  EpochSet taken_;                                     // cells that a change of this pass concerns
};

// Takes changes back. What that takes over its bounds follows.
class ChangesBack {
 public:
  ChangesBack(MeasuredCovering& work, std::vector<DualTriangle>& triangles, IntersectionTracker* meeting, const RunControl& control)
      : mesh_(work, triangles, meeting, control), control_(control) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      if (triangles[t].cell != work.triangles()[t].cell) flipped_.push_back(t);
    }
  }

  MeshEditor& mesh() { return mesh_; }

  // Flips around these cells; where there are none, moves. @return whether there was anything
  bool take_back(std::vector<CellId> cells) {
    const std::vector<CellError> before = mesh_.work().errors();
    bool any = false;
    for (int look = 0; !cells.empty(); ++look) {
      report_going_on(control_);
      const std::vector<CellId> at_flips = take_back_flips(cells);
      std::vector<CellId> changed = at_flips;
      for (const CellId c : cells) {
        if (fixed(c) == 1 && std::ranges::binary_search(at_flips, c)) continue;
        const bool was_given_up = fixed(c) == 3;
        mesh_.give_up(c, 3);
        if (put_back(c) || !was_given_up) changed.push_back(c);
      }
      if (changed.empty()) break;
      any = true;
      const std::vector<CellId> concerned = mesh_.concerned_by(changed);
      mesh_.measure(concerned);
      std::vector<CellId> worse;
      std::ranges::copy_if(concerned, std::back_inserter(worse), [&](CellId c) { return is_worse(mesh_.excess(c), before[c].excess); });
      cells = worse.empty() ? worse : look + 1 < kLooksBack ? mesh_.around(worse, 1) : mesh_.concerned_by(worse);
    }
    return any;
  }

  // Vertices that are not frozen go back to their c-vertices where surfels of one grid cell intersect as all are now. @return whether any
  // did
  bool settle() {
    std::vector<CellId> away;
    for (CellId c = 0; c < mesh_.placement().displacement.size(); ++c) {
      if (!mesh_.work().has_fixed_anchor(c) && !(mesh_.placement().displacement[c] == Vec3{})) away.push_back(c);
    }
    const std::vector<CellId> back = mesh_.keep_from_straying(away, std::vector<Vec3>(away.size()));
    if (!back.empty()) mesh_.measure(mesh_.concerned_by(back));
    return !back.empty();
  }

 private:
  std::uint8_t fixed(CellId c) const {
    const std::vector<std::uint8_t>& of = mesh_.placement().fixed;
    return c < of.size() ? of[c] : std::uint8_t{0};
  }

  // Flipped triangles become the dual's again, those that have a corner in common together. @return their corners, sorted
  std::vector<CellId> take_back_flips(std::span<const CellId> cells) {
    const std::vector<DualTriangle>& dual = mesh_.work().triangles();
    near_.clear();
    for (const CellId c : cells) near_.insert(c);
    std::vector<CellId> changed;
    for (std::size_t before = kNone; before != flipped_.size();) {
      control_.check_cancelled();
      before = flipped_.size();
      std::erase_if(flipped_, [&](std::uint32_t t) {
        std::array<CellId, 6> corners;
        std::ranges::copy(dual[t].cell, std::ranges::copy(mesh_.triangle(t).cell, corners.begin()).out);
        if (std::ranges::none_of(corners, [&](CellId c) { return near_.contains(c); })) return false;
        for (const CellId c : corners) near_.insert(c);
        changed.insert(changed.end(), corners.begin(), corners.end());
        mesh_.set_triangle(t, dual[t]);
        return true;
      });
    }
    sort_once(changed);
    for (const CellId c : changed) mesh_.give_up(c, 1);
    return changed;
  }

  // A vertex that is not frozen to its site, if that is free. @return whether it was elsewhere
  bool put_back(CellId c) {
    if (mesh_.work().has_fixed_anchor(c)) return false;
    const CVertexId site = mesh_.work().partition().site[c], anchor = mesh_.placement().anchor[c];
    const bool is_shifted = !mesh_.placement().displacement.empty() && !(mesh_.placement().displacement[c] == Vec3{});
    const bool moves = anchor != site && !mesh_.is_occupied(site);
    if (is_shifted || moves) mesh_.move(c, moves ? site : anchor, {});
    return is_shifted || moves;
  }

  MeshEditor mesh_;
  const RunControl& control_;
  std::vector<std::uint32_t> flipped_;  // triangles that are not the dual's
  EpochSet near_;                       // cells
};

}  // namespace

ShapeReport improve_shape(MeasuredCovering& work, const ShapeGoal& goal, std::vector<DualTriangle>& triangles, const RunControl& control) {
  ShapeReport report;
  triangles.assign(work.triangles().begin(), work.triangles().end());
  std::vector<CellId> over;
  for (CellId c = 0; c < work.errors().size(); ++c) {
    if (work.errors()[c].excess > 1) over.push_back(c);
  }
  work.remesh(triangles, {}, over);
  ShapeOptimizer optimizer(work, goal, triangles, control);
  optimizer.run(ShapeOptimizer::Purpose::shape, {}, report);
  for (int round = 0; round < kRelaxRounds && report.bad > 0 && optimizer.relax_bad(report); ++round)
    optimizer.run(ShapeOptimizer::Purpose::shape, {}, report);
  return report;
}

void improve_shape_carefully(MeasuredCovering& work, const ShapeGoal& goal, IntersectionTracker& meeting,
                             std::vector<DualTriangle>& triangles, ShapeReport& report, const RunControl& control) {
  ShapeOptimizer optimizer(work, goal, triangles, control, &meeting);
  for (int round = 0; round < kRelaxRounds && report.bad > 0 && optimizer.relax_bad(report); ++round)
    optimizer.run(ShapeOptimizer::Purpose::shape, {}, report);
}

void improve_errors(MeasuredCovering& work, const ShapeGoal& goal, std::span<const CellId> cells, std::vector<DualTriangle>& triangles,
                    ShapeReport& report, const RunControl& control) {
  ShapeOptimizer(work, goal, triangles, control).run(ShapeOptimizer::Purpose::errors, cells, report);
}

std::vector<CellId> take_back_meeting(MeasuredCovering& work, IntersectionTracker& meeting, std::vector<DualTriangle>& triangles,
                                      const RunControl& control) {
  ChangesBack changes(work, triangles, &meeting, control);
  for (;;) {
    std::vector<CellId> corners = changes.mesh().meeting_corners();
    if (corners.empty() || !changes.take_back(corners)) return corners;
  }
}

bool settle_vertices(MeasuredCovering& work, std::vector<DualTriangle>& triangles, const RunControl& control) {
  return ChangesBack(work, triangles, nullptr, control).settle();
}

void take_back_all(MeasuredCovering& work, std::vector<DualTriangle>& triangles, const RunControl& control) {
  ChangesBack(work, triangles, nullptr, control).take_back(all_cells(work));
}

}  // namespace isoatlas::detail
