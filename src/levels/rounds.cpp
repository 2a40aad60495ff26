// SPDX-License-Identifier: Apache-2.0
// Based on:
//   [gavriliu2001]  section 3.4, figure 8.
//   [boissonnat2005]  Provably good sampling and meshing of surfaces (a new vertex where the mesh
//   is farthest from the surface).
// Ours: steps finer than halving, priorities between soft constraints, shape as a reason to refine.
#include "levels/rounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "core/ranges.h"
#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

// Each round refines the cells with more than this share of the largest excess. (0.5 instead needs
// 1.8 times the rounds and measures 1.4 times the cells, for as many triangles.)
constexpr double kBand = 0.1;
// A cell's radius shrinks by the square root of its excess, limited to this range.
constexpr double kMinStep = 0.25, kMaxStep = 0.9;
// The c-vertex farthest from the mesh becomes a site if its distance from all sites is at least
// this share of its radius; nearer ones would require smaller disks than the error does.
constexpr float kMinSiteDistance = 0.55f;

// With a limit on vertices: number of consecutive failed steps after which refinement ends.
constexpr int kMaxFailures = 24;
// Share of the vertices that the initial bounds are estimated to need. (They need about half. 0.15
// instead of 0.3: 1.3 times the time, and errors that are 1 % smaller on average.)
constexpr double kInitialShare = 0.3;
constexpr double kExactAboveShare = 0.5;
// Estimated share of a level's time until all samples satisfy the bounds for the first time.
constexpr double kBoundsShare = 0.25;

// Refines until all bounds are satisfied as far as possible, or vertices run out.
bool is_at_shared_face(const MeasuredCovering& measured, const Triangle& triangle) {
  return ranges::any_of(triangle, [&](CellId c) {
    return measured.surface_data().is_on_shared_face(measured.partition().site[c]);
  });
}

class RefinementRun {
 public:
  RefinementRun(MeasuredCovering& measured, const RefinementTask& task, RefinedLevel& out)
      : measured_(measured), covering_(measured.covering()), task_(task), out_(out) {}

  /// @param report  called in each round with the largest excess of a cell that can be refined
  template <class Report>
  void run(const RunControl& control, Report report) {
    for (;; ++out_.rounds) {
      control.check_cancelled();
      measured_.update(out_.certificate, control);
      excluded_.resize(sites(), 0);
      find_excess_near_shared_faces();
      revert_if_too_much(control);
      if (sites() >= task_.max_sites || failures_ > kMaxFailures) {
        out_.vertex_limit_reached = true;
        return;
      }
      const double worst = worst_open();
      report(worst);
      Cells chosen = choose(worst);
      if (chosen.empty()) {
        if (!improve_shape()) return;
        continue;
      }
      limit_to_budget(chosen, worst);
      refine_cells(chosen, is_filling(worst));
    }
  }

 private:
  using Cells = std::vector<std::pair<double, CellId>>;  // with negated excess, so that sorting
                                                         // puts the worst first

  std::uint32_t sites() const { return covering_.site_count(); }
  bool is_limited() const { return task_.max_sites != kNone; }
  bool has_too_few() const { return sites() < task_.min_sites; }
  // Whether vertices are only added to reach their minimum number. Then cells become smaller
  // evenly, and no cell gets a second site.
  bool is_filling(double worst) const { return has_too_few() && worst <= 1; }
  CVertexId site(CellId c) const { return covering_.partition().site[c]; }
  double own_excess(CellId c) const { return measured_.errors()[c].excess; }
  double excess(CellId c) const {
    const auto near = excess_near_shared_faces_.find(c);
    return near == excess_near_shared_faces_.end() ? own_excess(c)
                                                   : std::max(own_excess(c), near->second);
  }
  float min_radius_at(CVertexId v) const {
    return min_useful_radius(task_, measured_.surface_data(), v);
  }
  bool can_shrink(CellId c) const { return covering_.radius()[site(c)] > min_radius_at(site(c)); }
  bool can_split(CellId c) const {
    const CVertexId x = measured_.errors()[c].worst;
    return x != kNone && own_excess(c) > 0 && covering_.distance()[x] >= min_radius_at(x);
  }
  bool is_refinable(CellId c) const { return !excluded_[c] && (can_shrink(c) || can_split(c)); }

  // A cell on a shared face is a single c-vertex. If it violates a bound, the cells around it must
  // become smaller. The sites on shared faces are the first ones.
  void find_excess_near_shared_faces() {
    excess_near_shared_faces_.clear();
    const SurfaceData& data = measured_.surface_data();
    for (CellId c = 0; c < sites() && data.is_on_shared_face(site(c)); ++c) {
      if (own_excess(c) <= 1) continue;
      for (const std::uint32_t t : measured_.mesh().triangles_of.row(c)) {
        for (const CellId other : measured_.mesh().triangles[t]) {
          if (data.is_on_shared_face(site(other))) continue;
          double& near = excess_near_shared_faces_[other];
          near = std::max(near, own_excess(c));
        }
      }
    }
  }

  // Reverts the last step and halves the batch if the step exceeded the limit, or if it used the
  // last vertex and increased the largest error. A single cell that needs too many vertices is
  // excluded.
  void revert_if_too_much(const RunControl& control) {
    const auto is_too_much = [&] {
      return sites() > task_.max_sites ||
             (sites() == task_.max_sites && worst_open() > worst_before_);
    };
    was_reverted_ = previous_site_count_ != kNone && is_too_much();
    if (!was_reverted_) {
      failures_ = 0;
    } else {
      if (batch_ == 1) ++failures_;
      if (batch_ == 1 && tried_ != kNone) excluded_[tried_] = 1;
      batch_ = std::max<std::size_t>(1, batch_ / 2);
      if (shape_step_.size() == 1) excluded_for_shape_.push_back(shape_step_.front());
      measured_.remove_sites(previous_site_count_, control);
      excluded_.resize(previous_site_count_);
      out_.certificate = certificate_before_;
      measured_.update(out_.certificate, control);
      find_excess_near_shared_faces();
    }
    shape_step_.clear();
  }

  void save_state() {
    if (!is_limited()) return;
    previous_site_count_ = sites();
    worst_before_ = worst_open();
    certificate_before_ = out_.certificate;
    tried_ = kNone;
  }

  double worst_open() const {
    double worst = 0;
    for (CellId c = 0; c < sites(); ++c) {
      if ((excess(c) > 1 || has_too_few()) && is_refinable(c)) worst = std::max(worst, excess(c));
    }
    return worst;
  }

  Cells choose(double worst) const {
    Cells out;
    if (worst <= 1 && !has_too_few()) return out;
    const double from = worst > 1 ? std::max(1.0, kBand * worst) : 0.8 * worst;
    for (CellId c = 0; c < sites(); ++c) {
      if (excess(c) >= from && (excess(c) > 1 || is_filling(worst)) && is_refinable(c))
        out.emplace_back(-excess(c), c);
    }
    std::sort(out.begin(), out.end());
    return out;
  }

  // Inserts sites where the corners of badly shaped triangles share a face, for the worst triangles
  // first. @return whether there are any
  bool improve_shape() {
    if (!task_.shape) return false;
    save_state();
    if (is_limited() && !was_reverted_)
      batch_ = std::max<std::size_t>(1, (task_.max_sites - sites()) / 6);
    if (!is_limited()) batch_ = kNone;
    std::vector<std::pair<double, CVertexId>> bad;
    for (std::size_t i = 0; i < measured_.mesh().triangles.size(); ++i) {
      if (is_at_shared_face(measured_, measured_.mesh().triangles[i])) continue;
      const auto [a, b, c] = measured_.mesh().corners(static_cast<std::uint32_t>(i));
      const double score = task_.shape->score(a, b, c);
      if (score >= 1) continue;
      const CVertexId v = measured_.triangles()[i].at;
      if (!covering_.is_covered(v) ||
          covering_.distance()[v] < min_radius(task_, measured_.surface_data(), v))
        continue;
      if (ranges::find(excluded_for_shape_, v) == excluded_for_shape_.end())
        bad.emplace_back(score, v);
    }
    std::sort(bad.begin(), bad.end());
    if (bad.size() > batch_) bad.resize(batch_);
    std::vector<Covering::Radius> lowered;
    for (const auto& [score, v] : bad) {
      lowered.push_back({v, covering_.distance()[v]});
      shape_step_.push_back(v);
    }
    covering_.lower_radii(lowered);
    return !bad.empty();
  }

  // Keeps the worst cells that the remaining vertices suffice for.
  void limit_to_budget(Cells& chosen, double worst) {
    if (!is_limited() && !has_too_few()) return;
    // A new site leads to a few more.
    const std::size_t room =
        (is_filling(worst) ? std::min(task_.min_sites, task_.max_sites) : task_.max_sites) -
        sites();
    const std::size_t wanted = batch_ == kNone ? room : was_reverted_ ? batch_ : 2 * batch_;
    batch_ = std::min({wanted, std::max<std::size_t>(1, room / 3), chosen.size()});
    chosen.resize(batch_);
    save_state();
    tried_ = chosen.front().second;
  }

  void refine_cells(const Cells& chosen, bool evenly) {
    std::vector<Covering::Radius> lowered;
    for (const auto& [minus_excess, c] : chosen) {
      const CVertexId v = site(c), x = measured_.errors()[c].worst;
      const auto is_far = [&] {
        return !evenly && covering_.distance()[x] >= kMinSiteDistance * covering_.radius()[x];
      };
      if (can_split(c) && (!can_shrink(c) || is_far())) {
        lowered.push_back({x, covering_.distance()[x]});
        covering_.insert(x);
      } else {
        const double step = std::clamp(1 / std::sqrt(-minus_excess), kMinStep, kMaxStep);
        lowered.push_back(
            {v, std::max(min_radius_at(v), static_cast<float>(step) * covering_.radius()[v])});
      }
    }
    covering_.lower_radii(lowered);
  }

  MeasuredCovering& measured_;
  Covering& covering_;
  const RefinementTask& task_;
  RefinedLevel& out_;
  std::uint32_t previous_site_count_ = kNone;  // before the last step, if that may be reverted
  CertificateReport certificate_before_;
  double worst_before_ = 0;  // largest excess before the last step
  CellId tried_ = kNone;     // the worst cell of that step, if it refined cells
  bool was_reverted_ = false;
  // Per cell next to one on a shared face that violates a bound, the excess of that one.
  std::unordered_map<CellId, double> excess_near_shared_faces_;
  // sites that the last step inserted to improve shape; those that exceeded the limit
  std::vector<CVertexId> shape_step_, excluded_for_shape_;
  std::vector<std::uint8_t> excluded_;  // per cell, 1 if refining it exceeded the limit on vertices
  std::size_t batch_ = kNone;           // number of cells refined at once
  int failures_ = 0;                    // consecutive failures of single cells
};

// The factor by which bounds must be relaxed to need about this many cells, no larger than all
// cells need: a cell that violates a bound by a factor is expected to become that many cells.
double initial_relaxation(std::span<const CellError> errors, double cells) {
  double sum = 0, largest = 1;
  for (const CellError& e : errors) {
    if (!std::isfinite(e.excess)) continue;
    sum += e.excess;
    largest = std::max(largest, e.excess);
  }
  return std::clamp(sum / cells, 1.0, largest);
}

// The factor by which bounds are tightened next. The number of cells is inversely proportional to
// the bound, so large steps lead to about 0.6 of the vertices, and small ones use the rest: bounds
// that are satisfied are measured completely, bounds that run out of vertices are not.
double next_step(double share_used) {
  return share_used < 0.5 ? std::clamp(share_used / 0.6, 0.1, 0.7)
                          : std::clamp(share_used, 0.85, 0.97);
}

}  // namespace

std::vector<Constraint> relaxed_bounds(const std::vector<Constraint>& metrics, double relaxation) {
  std::vector<Constraint> out;
  for (const Constraint& c : metrics) out.push_back(scaled(c, relaxation));
  if (out.empty())
    out.push_back({Quantity::max_distance,
                   std::numeric_limits<double>::max()});  // no bound; only ranks cells
  return out;
}

bool shrink_cells_at_bad_triangles(MeasuredCovering& measured, const RefinementTask& task,
                                   const std::vector<DualTriangle>& triangles) {
  const Covering& covering = measured.covering();
  std::vector<Covering::Radius> lowered;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (is_at_shared_face(measured, measured.mesh().triangles[i])) continue;
    const std::array<Vec3, 3> corner = measured.mesh().corners(static_cast<std::uint32_t>(i));
    if (task.shape->score(corner[0], corner[1], corner[2]) >= 1) continue;
    for (const CellId c : measured.mesh().triangles[i]) {
      const CVertexId v = measured.partition().site[c];
      const float radius = covering.radius()[v],
                  limit = min_radius(task, measured.surface_data(), v);
      if (radius <= limit) continue;
      lowered.push_back({v, std::max(limit, 0.8f * radius)});
    }
  }
  measured.covering().lower_radii(lowered);
  return !lowered.empty();
}

// Refines until the task is finished as far as possible, or vertices run out. With a limit on
// vertices, bounds are first relaxed and then tightened step by step, so that the available
// vertices go where they reduce the largest error over the whole surface.
void RefinementRounds::refine(MeasuredCovering& measured, const RefinementTask& task,
                              RefinedLevel& out, const RunControl& control) {
  measured.set_bounds(relaxed_bounds(task.metrics), task.placement);
  if (task.max_sites == kNone || task.metrics.empty()) {
    refine_to_bounds(measured, task, out, control);
    return;
  }
  measured.update(out.certificate, control);
  double relaxation = initial_relaxation(measured.errors(), kInitialShare * task.max_sites);
  measured.set_bounds(relaxed_bounds(task.metrics, relaxation), task.placement, kExactAboveShare);
  RefinementTask bounds_only = task;
  bounds_only.min_sites = 0;
  while (relaxation > 1) {
    refine_to_bounds(measured, bounds_only, out, control);
    if (out.vertex_limit_reached) return;
    const double step =
        std::max(next_step(static_cast<double>(measured.covering().site_count()) / task.max_sites),
                 1 / relaxation);
    relaxation *= step;
    measured.tighten_bounds(step);
  }
  refine_to_bounds(measured, task, out, control);
}

void RefinementRounds::refine_to_bounds(MeasuredCovering& measured, const RefinementTask& task,
                                        RefinedLevel& out, const RunControl& control) {
  RefinementRun(measured, task, out).run(control, [&](double worst) {
    control.report("refine", kBoundsShare * progress_of(worst));
  });
}

// The worst error decreases by about the same factor in each round, and rounds take longer and
// longer.
double RefinementRounds::progress_of(double worst) {
  if (!(worst > 1)) return 1;
  if (!std::isfinite(worst)) return 0;
  first_worst_ = std::max(first_worst_, worst);
  const double share = 1 - std::log(worst) / std::log(first_worst_);
  return share * share;
}

}  // namespace isoatlas::detail
