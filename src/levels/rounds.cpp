// SPDX-License-Identifier: Apache-2.0
// Based on:
//   [gavriliu2001]  section 3.4, figure 8.
//   [boissonnat2005]  Provably good sampling and meshing of surfaces (a new vertex where the mesh is farthest from the surface).
// Ours: steps finer than halving, priorities between soft constraints, shape as a reason to refine.
#include "levels/rounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

// In one round: the cells with more than this share of the worst excess. (A band of 0.5 instead needs 1.8 times the rounds and measures 1.4
// times the cells, for as many triangles.)
constexpr double kBand = 0.1;
// A cell's radius becomes smaller by the square root of its excess, but in steps between these.
constexpr double kLeastStep = 0.25, kLargestStep = 0.9;
// The c-vertex farthest from the mesh becomes a site if it is at least this share of its radius away from all sites: nearer ones
// would ask for smaller disks than the error does.
constexpr float kFarEnough = 0.55f;

// Under a limit on vertices: how often in a row a step may fail before it is over.
constexpr int kMostFailures = 24;
// The share of the vertices that the first bounds are estimated to need. (They need about half. 0.15 instead of 0.3: 1.3 times the time,
// and errors that are 1 % smaller on average.)
constexpr double kFirstShare = 0.3;
constexpr double kNearEnough = 0.5;
// Of the time of a level, that goes by until bounds are met at the samples for the first time.
constexpr double kMeetShare = 0.25;

// Until all demands are met as far as they can be, or vertices run out.
class Stretch {
 public:
  Stretch(MeasuredCovering& work, const RefinementTask& task, RefinedLevel& out)
      : work_(work), covering_(work.covering()), task_(task), out_(out) {}

  /// @param report  is told the worst excess of each round that can be helped
  template <class Report>
  void run(const RunControl& control, Report report) {
    for (;; ++out_.rounds) {
      control.check_cancelled();
      work_.update(out_.certificate, control);
      given_up_.resize(sites(), 0);
      take_back_if_too_much(control);
      if (sites() >= task_.most_sites || failures_ > kMostFailures) {
        out_.vertices_ran_out = true;
        return;
      }
      const double worst = worst_of_open();
      report(worst);
      Cells chosen = choose(worst);
      if (chosen.empty()) {
        if (!improve_shape()) return;
        continue;
      }
      keep_to_limits(chosen, worst);
      make_smaller(chosen, fills(worst));
    }
  }

 private:
  using Cells = std::vector<std::pair<double, CellId>>;  // with minus their excess, so that the worst are first

  std::uint32_t sites() const { return covering_.site_count(); }
  bool is_limited() const { return task_.most_sites != kNone; }
  bool has_too_few() const { return sites() < task_.least_sites; }
  // Vertices that nothing but their number asks for. Evenly: cells become smaller, none gets a site beside its own.
  bool fills(double worst) const { return has_too_few() && worst <= 1; }
  CVertexId site(CellId c) const { return covering_.partition().site[c]; }
  double excess(CellId c) const { return work_.errors()[c].excess; }
  float least(CVertexId v) const { return least_useful_radius(task_, work_.surface_data(), v); }
  bool can_shrink(CellId c) const { return covering_.radius()[site(c)] > least(site(c)); }
  bool can_split(CellId c) const {
    const CVertexId x = work_.errors()[c].worst;
    return x != kNone && covering_.distance()[x] >= least(x);
  }
  bool is_open(CellId c) const { return !given_up_[c] && (can_shrink(c) || can_split(c)); }

  // Removes the sites of the last step and tries less at once if the step exceeded the limit, or if it used the last vertex and raised the
  // largest error. A single cell that needs too much is left as it is.
  void take_back_if_too_much(const RunControl& control) {
    const auto is_too_much = [&] { return sites() > task_.most_sites || (sites() == task_.most_sites && worst_of_open() > worst_before_); };
    took_back_ = sites_before_ != kNone && is_too_much();
    if (!took_back_) {
      failures_ = 0;
    } else {
      if (batch_ == 1) ++failures_;
      if (batch_ == 1 && tried_ != kNone) given_up_[tried_] = 1;
      batch_ = std::max<std::size_t>(1, batch_ / 2);
      if (shape_step_.size() == 1) shape_given_up_.push_back(shape_step_.front());
      work_.remove_sites(sites_before_, control);
      given_up_.resize(sites_before_);
      out_.certificate = certificate_before_;
      work_.update(out_.certificate, control);
    }
    shape_step_.clear();
  }

  void remember() {
    if (!is_limited()) return;
    sites_before_ = sites();
    worst_before_ = worst_of_open();
    certificate_before_ = out_.certificate;
    tried_ = kNone;
  }

  double worst_of_open() const {
    double worst = 0;
    for (CellId c = 0; c < sites(); ++c) {
      if ((excess(c) > 1 || has_too_few()) && is_open(c)) worst = std::max(worst, excess(c));
    }
    return worst;
  }

  Cells choose(double worst) const {
    Cells out;
    if (worst <= 1 && !has_too_few()) return out;
    const double from = worst > 1 ? std::max(1.0, kBand * worst) : 0.8 * worst;
    for (CellId c = 0; c < sites(); ++c) {
      if (excess(c) >= from && (excess(c) > 1 || fills(worst)) && is_open(c)) out.emplace_back(-excess(c), c);
    }
    std::sort(out.begin(), out.end());
    return out;
  }

  // Puts sites where the corners of badly shaped triangles meet, of the worst ones first. @return whether there are any
  bool improve_shape() {
    if (!task_.shape) return false;
    remember();
    if (is_limited() && !took_back_) batch_ = std::max<std::size_t>(1, (task_.most_sites - sites()) / 6);
    if (!is_limited()) batch_ = kNone;
    std::vector<std::pair<double, CVertexId>> bad;
    for (std::size_t i = 0; i < work_.mesh().triangles.size(); ++i) {
      const auto [a, b, c] = work_.mesh().corners(static_cast<std::uint32_t>(i));
      const double score = task_.shape->score(a, b, c);
      if (score >= 1) continue;
      const CVertexId v = work_.triangles()[i].at;
      if (!covering_.is_covered(v) || covering_.distance()[v] < least_radius(task_, work_.surface_data(), v)) continue;
      if (std::ranges::find(shape_given_up_, v) == shape_given_up_.end()) bad.emplace_back(score, v);
    }
    std::sort(bad.begin(), bad.end());
    if (bad.size() > batch_) bad.resize(batch_);
    std::vector<Covering::Radius> lower;
    for (const auto& [score, v] : bad) {
      lower.push_back({v, covering_.distance()[v]});
      shape_step_.push_back(v);
    }
    covering_.lower_radii(lower);
    return !bad.empty();
  }

  // As many of the worst as there is room for.
  void keep_to_limits(Cells& chosen, double worst) {
    if (!is_limited() && !has_too_few()) return;
    // A new site brings a few more with it.
    const std::size_t room = (fills(worst) ? std::min(task_.least_sites, task_.most_sites) : task_.most_sites) - sites();
    const std::size_t wanted = batch_ == kNone ? room : took_back_ ? batch_ : 2 * batch_;
    batch_ = std::min({wanted, std::max<std::size_t>(1, room / 3), chosen.size()});
    chosen.resize(batch_);
    remember();
    tried_ = chosen.front().second;
  }

  void make_smaller(const Cells& chosen, bool evenly) {
    std::vector<Covering::Radius> lower;
    for (const auto& [minus_excess, c] : chosen) {
      const CVertexId v = site(c), x = work_.errors()[c].worst;
      const auto is_far = [&] { return !evenly && covering_.distance()[x] >= kFarEnough * covering_.radius()[x]; };
      if (can_split(c) && (!can_shrink(c) || is_far())) {
        lower.push_back({x, covering_.distance()[x]});
        covering_.insert(x);
      } else {
        const double step = std::clamp(1 / std::sqrt(-minus_excess), kLeastStep, kLargestStep);
        lower.push_back({v, std::max(least(v), static_cast<float>(step) * covering_.radius()[v])});
      }
    }
    covering_.lower_radii(lower);
  }

  MeasuredCovering& work_;
  Covering& covering_;
  const RefinementTask& task_;
  RefinedLevel& out_;
  std::uint32_t sites_before_ = kNone;  // the last step, if it may have to be taken back
  CertificateReport certificate_before_;
  double worst_before_ = 0;  // excess
  CellId tried_ = kNone;     // the worst cell of that step, if it was about cells
  bool took_back_ = false;
  std::vector<CVertexId> shape_step_, shape_given_up_;  // where the last step put sites for the sake of shape; where that led too far
  std::vector<std::uint8_t> given_up_;                  // per cell, 1 if a step there led over the limit on vertices
  std::size_t batch_ = kNone;                           // how many cells at once
  int failures_ = 0;                                    // in a row, of single cells
};

// How many times as generous bounds have to be for about so many cells: one that violates a bound by a factor is expected to become as
// many. No more generous than all cells need.
double first_generosity(std::span<const CellError> errors, double cells) {
  double sum = 0, most = 1;
  for (const CellError& e : errors) {
    if (!std::isfinite(e.excess)) continue;
    sum += e.excess;
    most = std::max(most, e.excess);
  }
  return std::clamp(sum / cells, 1.0, most);
}

// By what factor bounds become tighter next. The number of cells goes with one over the bound, so large steps lead near to 0.6 of the
// vertices, and the last ones to all of them: bounds that are satisfied are measured completely, those that vertices run out for are not.
double next_step(double share_used) {
  return share_used < 0.5 ? std::clamp(share_used / 0.6, 0.1, 0.7) : std::clamp(share_used, 0.85, 0.97);
}

}  // namespace

std::vector<Constraint> demands_of(const std::vector<Constraint>& metrics, double generosity) {
  std::vector<Constraint> out;
  for (const Constraint& c : metrics) out.push_back(scaled(c, generosity));
  if (out.empty()) out.push_back({Quantity::max_distance, std::numeric_limits<double>::max()});  // only says which cells are worst
  return out;
}

bool make_smaller_at_bad_triangles(MeasuredCovering& work, const RefinementTask& task, const std::vector<DualTriangle>& triangles) {
  const Covering& covering = work.covering();
  std::vector<Covering::Radius> lower;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::array<Vec3, 3> corner = work.mesh().corners(static_cast<std::uint32_t>(i));
    if (task.shape->score(corner[0], corner[1], corner[2]) >= 1) continue;
    for (const CellId c : work.mesh().triangles[i]) {
      const CVertexId v = work.partition().site[c];
      const float radius = covering.radius()[v], least = least_radius(task, work.surface_data(), v);
      if (radius <= least) continue;
      lower.push_back({v, std::max(least, 0.8f * radius)});
    }
  }
  work.covering().lower_radii(lower);
  return !lower.empty();
}

// Until the task is done as far as it can be, or vertices run out. If they may, bounds are first more generous and then less and less so:
// what vertices there are then go where they lower the largest error, looked at from all sides.
void RefinementRounds::work(MeasuredCovering& work, const RefinementTask& task, RefinedLevel& out, const RunControl& control) {
  work.set_bounds(demands_of(task.metrics), task.placement);
  if (task.most_sites == kNone || task.metrics.empty()) {
    meet(work, task, out, control);
    return;
  }
  work.update(out.certificate, control);
  double generosity = first_generosity(work.errors(), kFirstShare * task.most_sites);
  work.set_bounds(demands_of(task.metrics, generosity), task.placement, kNearEnough);
  RefinementTask part = task;
  part.least_sites = 0;
  while (generosity > 1) {
    meet(work, part, out, control);
    if (out.vertices_ran_out) return;
    const double step = std::max(next_step(static_cast<double>(work.covering().site_count()) / task.most_sites), 1 / generosity);
    generosity *= step;
    work.tighten_bounds(step);
  }
  meet(work, task, out, control);
}

void RefinementRounds::meet(MeasuredCovering& work, const RefinementTask& task, RefinedLevel& out, const RunControl& control) {
  Stretch(work, task, out).run(control, [&](double worst) { control.report("refine", kMeetShare * done_of_meeting(worst)); });
}

// The worst error becomes smaller by about the same factor in each round, and rounds become longer.
double RefinementRounds::done_of_meeting(double worst) {
  if (!(worst > 1)) return 1;
  if (!std::isfinite(worst)) return 0;
  first_worst_ = std::max(first_worst_, worst);
  const double share = 1 - std::log(worst) / std::log(first_worst_);
  return share * share;
}

}  // namespace isoatlas::detail
