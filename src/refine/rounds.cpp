// SPDX-License-Identifier: Apache-2.0
// Based on:
//   [gavriliu2001]  section 3.4, figure 8.
//   [boissonnat2005]  Provably good sampling and meshing of surfaces (a new vertex where the mesh is farthest from the surface).
// Ours: steps finer than halving, priorities between soft constraints, shape as a reason to refine.
#include "refine/rounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "core/vector_math.h"

namespace isoatlas {
namespace {

// In one round: the cells with more than this share of the worst excess. (A band of 0.5 instead needs 1.8 times the rounds and measures 1.4 times
// the cells, for as many triangles.)
constexpr double kBand = 0.1;
// A cell's radius becomes smaller by the square root of its excess, but in steps between these.
constexpr double kLeastStep = 0.25, kLargestStep = 0.9;
// The c-vertex farthest from the mesh becomes a site if it is at least this share of its radius away from all sites: nearer ones
// would ask for smaller disks than the error does.
constexpr float kFarEnough = 0.55f;

// Under a limit on vertices: how often in a row a step may fail before it is over.
constexpr int kMostFailures = 24;
// How much less generous bounds become: while fewer than half of the vertices are used, and then.
constexpr double kFirstSteps = 0.7, kLastSteps = 0.85;
constexpr double kNearEnough = 0.5;
// Of the time of a level, that goes by until bounds are met at the samples.
constexpr double kMeetShare = 0.6;

// Puts sites where the corners of badly shaped triangles meet, of the worst ones first. @return where
std::vector<CVertexId> work_on_shape(MeasuredCovering& work, const RefinementTask& task, std::size_t room, std::span<const CVertexId> given_up) {
  Covering& covering = work.covering();
  std::vector<std::pair<double, CVertexId>> bad;
  for (std::size_t i = 0; i < work.mesh().triangles.size(); ++i) {
    const MeshTriangle& t = work.mesh().triangles[i];
    const double score = task.shape->score(t.corner[0], t.corner[1], t.corner[2]);
    if (score >= 1) continue;
    const CVertexId v = work.triangles()[i].at;
    const float d = covering.distance()[v];
    if (!covering.is_covered(v) || d < least_radius(task, work.ground(), v)) continue;
    if (std::find(given_up.begin(), given_up.end(), v) == given_up.end()) bad.emplace_back(score, v);
  }
  std::sort(bad.begin(), bad.end());
  if (bad.size() > room) bad.resize(room);
  std::vector<CVertexId> out;
  std::vector<Covering::Radius> lower;
  for (const auto& [score, v] : bad) {
    lower.push_back({v, covering.distance()[v]});
    out.push_back(v);
  }
  covering.lower_radii(lower);
  return out;
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
    const MeshTriangle& t = work.mesh().triangles[i];
    if (task.shape->score(t.corner[0], t.corner[1], t.corner[2]) >= 1) continue;
    for (const CellId c : t.cell) {
      const CVertexId v = work.partition().site[c];
      const float radius = covering.radius()[v], least = least_radius(task, work.ground(), v);
      if (radius <= least) continue;
      lower.push_back({v, std::max(least, 0.8f * radius)});
    }
  }
  work.covering().lower_radii(lower);
  return !lower.empty();
}

// Until the task is done as far as it can be, or vertices run out. If they may, bounds are first meant more generously and then less
// and less so: what vertices there are then go where they lower the largest error, looked at from all sides.
void RefinementRounds::work(MeasuredCovering& work, const RefinementTask& task, RefinedLevel& out, const RunControl& control) {
  work.demand(demands_of(task.metrics), task.placement);
  if (task.most_sites == kNone || task.metrics.empty()) {
    meet(work, task, out, control);
    return;
  }
  work.update(out.certificate, control);
  double generosity = 1;
  for (const CellError& e : work.errors()) {
    if (std::isfinite(e.excess)) generosity = std::max(generosity, e.excess);
  }
  work.demand(demands_of(task.metrics, generosity), task.placement, kNearEnough);
  work.update(out.certificate, control);
  RefinementTask part = task;
  part.least_sites = 0;
  while (generosity > 1 && !out.vertices_ran_out) {
    const bool many_left = 2 * std::size_t{work.covering().site_count()} < task.most_sites;
    const double step = std::max(many_left ? kFirstSteps : kLastSteps, 1 / generosity);
    generosity *= step;
    work.tighten(step);
    if (generosity > 1) meet(work, part, out, control);
  }
  if (!out.vertices_ran_out) meet(work, task, out, control);
}

// Until all demands are met as far as they can be, or vertices run out.
void RefinementRounds::meet(MeasuredCovering& work, const RefinementTask& task, RefinedLevel& out, const RunControl& control) {
  std::unique_ptr<MeasuredCovering> before;  // the last step, while steps may have to be taken back
  CertificateReport certificate_before;
  const auto remember = [&] {
    before = std::make_unique<MeasuredCovering>(work);
    certificate_before = out.certificate;
  };
  std::vector<CVertexId> shape_step, shape_given_up;  // where the last step put sites for the sake of shape; where that led too far
  const auto least = [&](CVertexId v) { return least_radius(task, work.ground(), v); };
  std::vector<std::uint8_t> given_up;  // per cell, 1 if a step there led over the limit on vertices
  std::size_t batch = kNone;
  int failures = 0;
  for (;; ++out.rounds) {
    control.check_cancelled();
    work.update(out.certificate, control);
    Covering& covering = work.covering();
    const bool too_many = before && covering.site_count() > task.most_sites;
    if (too_many) {
      // Too many: back, and try less at once. A single cell that needs too much is left as it is.
      if (batch == 1) {
        ++failures;
      }
      batch = std::max<std::size_t>(1, batch / 2);
      if (shape_step.size() == 1) shape_given_up.push_back(shape_step.front());
      work = *before;
      out.certificate = certificate_before;
      work.update(out.certificate, control);
    } else {
      failures = 0;
    }
    shape_step.clear();
    const std::uint32_t sites = covering.site_count();
    if (sites >= task.most_sites || failures > kMostFailures) {
      out.vertices_ran_out = true;
      return;
    }

    const std::vector<CellError>& errors = work.errors();
    const Partition& partition = work.partition();
    given_up.resize(sites, 0);

    // The worst first.
    double worst = 0;
    const bool too_few = sites < task.least_sites;
    const auto can_shrink = [&](CellId c) { return covering.radius()[partition.site[c]] > least(partition.site[c]); };
    const auto can_split = [&](CellId c) {
      const CVertexId x = errors[c].worst;
      return x != kNone && covering.distance()[x] >= least(x);
    };
    const auto is_open = [&](CellId c) { return !given_up[c] && (can_shrink(c) || can_split(c)); };
    for (CellId c = 0; c < sites; ++c) {
      if ((errors[c].excess > 1 || too_few) && is_open(c)) worst = std::max(worst, errors[c].excess);
    }
    control.report("refine", kMeetShare * done_of_meeting(worst));
    std::vector<std::pair<double, CellId>> chosen;
    const bool fills = too_few && worst <= 1;  // evenly: cells become smaller, none gets a site beside its own
    const double from = worst > 1 ? std::max(1.0, kBand * worst) : too_few ? 0.8 * worst : 2.0;
    for (CellId c = 0; c < sites; ++c) {
      if (errors[c].excess >= from && (errors[c].excess > 1 || fills) && is_open(c))
        chosen.emplace_back(-errors[c].excess, c);
    }
    std::sort(chosen.begin(), chosen.end());

    if (chosen.empty()) {
      if (!task.shape) return;
      const bool limited = task.most_sites != kNone;
      if (limited) remember();
      const std::size_t room = !limited ? kNone : too_many ? batch : std::max<std::size_t>(1, (task.most_sites - sites) / 6);
      batch = room;
      shape_step = work_on_shape(work, task, room, shape_given_up);
      if (shape_step.empty()) return;
      continue;
    }
    if (task.most_sites != kNone || too_few) {
      // A new site brings a few more with it.
      const std::size_t room = (fills ? std::min(task.least_sites, task.most_sites) : task.most_sites) - sites;
      const std::size_t wanted = batch == kNone ? room : too_many ? batch : 2 * batch;
      batch = std::min({wanted, std::max<std::size_t>(1, room / 3), chosen.size()});
      if (failures > 0) {
        given_up[chosen.front().second] = 1;
        chosen.erase(chosen.begin());
        batch = 1;
        if (chosen.empty()) continue;
      }
      chosen.resize(std::min(chosen.size(), batch));
      if (task.most_sites != kNone) remember();
    }
    std::vector<Covering::Radius> lower;
    for (const auto& [excess, c] : chosen) {
      const CVertexId v = partition.site[c], x = errors[c].worst;
      const float radius = covering.radius()[v];
      const auto is_far = [&] { return !fills && covering.distance()[x] >= kFarEnough * covering.radius()[x]; };
      if (can_split(c) && (!can_shrink(c) || is_far())) {
        lower.push_back({x, covering.distance()[x]});
        covering.insert(x);
      } else {
        const double step = std::clamp(1 / std::sqrt(-excess), kLeastStep, kLargestStep);
        lower.push_back({v, std::max(least(v), static_cast<float>(step) * radius)});
      }
    }
    covering.lower_radii(lower);
  }
}

// The worst error becomes smaller by about the same factor in each round, and rounds become longer.
double RefinementRounds::done_of_meeting(double worst) {
  if (!(worst > 1)) return 1;
  if (!std::isfinite(worst)) return 0;
  first_worst_ = std::max(first_worst_, worst);
  const double share = 1 - std::log(worst) / std::log(first_worst_);
  return share * share;
}

}  // namespace isoatlas
