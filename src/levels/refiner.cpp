// SPDX-License-Identifier: Apache-2.0
// Stage two: adaptive refinement.
//
// Based on:
//   [gavriliu2001]  sections 3.4 and 3.5, figure 8.
//   [boissonnat2005]  Provably good sampling and meshing of surfaces (a new vertex where the mesh
//   is farthest from the surface).
// Ours: steps finer than halving, priorities between soft constraints, shape as a reason to refine
// (docs/theory/05-refinement.md).
#include "levels/refiner.h"
#include "error/custom_metric.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/ranges.h"
#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "embedding/resolve_intersections.h"
#include "levels/predict_radii.h"

namespace isoatlas::detail {
namespace {

// The coarser complex has few c-vertices; refinement there stops well above its resolution limit,
// because the surface itself places sites better.
constexpr float kCoarserLimitShare = 2;

constexpr int kMaxBalanceRounds = 3;
constexpr int kMaxFailedProofs = 10;
// Share of a level's time until the shape of its triangles was improved.
constexpr double kShapeShare = 0.85;
// If few badly shaped triangles remain, their cells are refined this many more times, but only this
// often in a row without removing at least the share below of them.
constexpr int kMaxRetries = 6, kMaxVainRetries = 2;
constexpr double kMinRetryGain = 0.05;
constexpr std::size_t kMaxRetriedTriangles = 100;
// Number of cells at the resolution limit that are improved by flips and moves.
constexpr std::size_t kMaxRepairedCells = 200;
// A cell whose radius is this share of a bound on the distance satisfies the bound, unless its
// vertices are off the surface, and then smaller cells do not help.
constexpr double kUsefulShare = 0.4;
// Each subdivision for a bound includes the faces around this many c-vertices, or this fraction of
// all of them.
constexpr std::size_t kMinSubdivided = 6, kSubdividedDivisor = 20;
// The surface is subdivided again while at most kMaxRemainingShare of the violating cells remain
// and the largest excess decreases, or while at most kFewRemaining of them remain.
constexpr double kMaxRemainingShare = 0.75, kFewRemaining = 0.1;

// @param to  the c-vertices on another complex; empty: the same complex
std::vector<Covering::Radius> radii_of(std::span<const float> radius,
                                       std::span<const CVertexId> to) {
  std::vector<Covering::Radius> out;
  out.reserve(radius.size());
  for (CVertexId v = 0; v < radius.size(); ++v) out.push_back({to.empty() ? v : to[v], radius[v]});
  return out;
}

std::vector<float> distances(std::span<const MetricValues> values) {
  std::vector<float> out;
  out.reserve(values.size());
  for (const MetricValues& v : values)
    out.push_back(static_cast<float>(v[static_cast<std::size_t>(Quantity::max_distance)]));
  return out;
}

bool drives_refinement(Quantity q) {
  return is_metric(q) || q == Quantity::max_edge || q == Quantity::custom;
}

bool is_limited(const LevelGoal& goal) {
  return !goal.empty() && goal.front().quantity == Quantity::max_vertices;
}

constexpr auto kMaxDistance = static_cast<std::size_t>(Quantity::max_distance);
// In voxels: bounds that are tried in addition if a tighter one cannot be satisfied.
constexpr std::array kLooserBounds{0.5, 0.4, 0.32, 0.256};

// The bound on the distance if the user set a tight one with the highest priority and no limit on
// vertices; otherwise 0.
double tight_distance(const LevelGoal& goal) {
  if (ranges::find(goal, Quantity::max_vertices, &Constraint::quantity) != goal.end()) return 0;
  const bool is_tight = !goal.empty() && goal.front().quantity == Quantity::max_distance &&
                        !goal.front().is_default && goal.front().bound < kLooserBounds.front();
  return is_tight ? goal.front().bound : 0;
}

LevelGoal with_distance(LevelGoal goal, double bound) {
  for (Constraint& c : goal) {
    if (c.quantity == Quantity::max_distance) c.bound = bound;
  }
  return goal;
}

}  // namespace

Refiner::Refiner(AdaptiveSurface& surface, const Isosurface& isosurface, const Coarsened& coarser,
                 const CoveringOptions& options, Start start,
                 std::optional<OutputPositions> output_positions, std::uint32_t max_subdivisions)
    : options_(options),
      surface_(surface),
      coarser_(coarser),
      start_(std::move(start)),
      output_positions_(std::move(output_positions)),
      max_subdivisions_(max_subdivisions),
      surface_data_(std::make_unique<SurfaceData>(surface.complex(), &isosurface, &surface)),
      previous_site_count_(static_cast<std::uint32_t>(start_.placement.anchor.size())) {}

void Refiner::refine_coarser_complex(const LevelGoal& goal, Placement placement, RefinedLevel& out,
                                     const RunControl& control) {
  const std::vector<CVertexId>& on = coarser_.representative;
  std::vector<CVertexId> sites = start_.placement.anchor;
  std::vector<Covering::Radius> radii;
  if (on.empty()) {
    radii = radii_of(start_.radius, {});
  } else {
    const SurfaceData surface_data(coarser_.complex, nullptr, nullptr, &control);
    MeasuredCovering coarse(surface_data, options_, start_.site, radii_of(start_.radius, {}),
                            control);
    Task task;
    task.placement = placement;
    task.limit_share = kCoarserLimitShare;
    for (const Constraint& c : goal) {
      if (drives_refinement(c.quantity)) task.metrics.push_back(c);
      // Leave some vertices for refinement on the surface itself.
      if (c.quantity == Quantity::max_vertices)
        task.max_sites = static_cast<std::uint32_t>(0.6 * std::min(c.bound, 4e9));
      if (c.quantity == Quantity::min_edge) task.min_edge = static_cast<float>(c.bound);
    }
    if (!task.metrics.empty() && coarse.covering().site_count() < task.max_sites) {
      rounds_.refine(coarse, task, out, control);
      out.vertex_limit_reached = false;  // the limit here was only a share of it
    }
    inserted_in_ = coarse.covering().inserted_in();
    sites.clear();
    for (const CVertexId v : coarse.partition().site) sites.push_back(on[v]);
    radii = radii_of(coarse.covering().radius(), on);
  }
  measured_ = std::make_unique<MeasuredCovering>(*surface_data_, options_, sites, radii, control);
  measured_->set_displacement(start_.placement.displacement);
  measured_->fix_anchors(previous_site_count_);
}

// @return whether any of the cells, or the surface there, can be refined
bool Refiner::refine_cells(std::span<const CellId> cells, const RunControl& control) {
  const std::vector<CellId> single = measured_->covering().shrink(cells);
  if (single.size() < cells.size())
    return true;  // subdivide the surface only where nothing else helps
  return subdivide(single, control);
}

// Subdivides the surface at cells that are single c-vertices. @return whether that was possible
bool Refiner::subdivide(std::span<const CellId> single, const RunControl& control) {
  const std::vector<CVertexId> wanted = filter_subdividable(surface_, sites_of(single));
  if (!wanted.empty()) subdivide_surface(wanted, control);
  return !wanted.empty();
}

std::vector<CVertexId> Refiner::sites_of(std::span<const CellId> cells) const {
  std::vector<CVertexId> out;
  for (const CellId c : cells) out.push_back(partition().site[c]);
  return out;
}

// Whether refine_cells() would have an effect.
bool Refiner::can_refine(std::span<const CellId> cells) const {
  std::vector<CellId> single;
  for (const CellId c : cells) {
    if (measured_->mesh().c_vertices_of.row(c).size() == 1) single.push_back(c);
  }
  return single.size() < cells.size() || !filter_subdividable(surface_, sites_of(single)).empty();
}

// A refined level while its self-intersections are resolved.
class Refiner::Dual : public GrowingDual {
 public:
  Dual(Refiner& refiner, CertificateReport& certificate, const RunControl& control)
      : refiner_(refiner), certificate_(certificate), control_(control) {}

  Covering& covering() override { return refiner_.measured_->covering(); }
  const SurfaceComplex& complex() const override { return refiner_.surface_.complex(); }
  void update() override { refiner_.measured_->update(certificate_, control_); }
  std::vector<Vec3> positions() const override { return refiner_.measured_->positions(); }
  std::vector<Triangle> triangles() const override {
    return to_triangles(refiner_.measured_->triangles());
  }
  std::vector<CVertexId> sites_on_surface() const override { return refiner_.partition().site; }
  bool subdivide(std::span<const CellId> single) override {
    update();  // the other cells have become smaller
    return refiner_.subdivide(single, control_);
  }

 private:
  Refiner& refiner_;
  CertificateReport& certificate_;
  const RunControl& control_;
};

// @return whether anything has changed
bool Refiner::separate_intersections(IntersectionTracker& tracker, RefinedLevel& out,
                                     const RunControl& control) {
  const std::uint32_t sites = partition().cell_count();
  Dual dual(*this, out.certificate, control);
  const bool any = resolve_intersections(dual, surface_, tracker, control).has_changed;
  out.sites_for_intersections += partition().cell_count() - sites;
  return any;
}

// Refines for the task until there are no self-intersections.
void Refiner::refine_and_separate(const Task& task, IntersectionTracker& tracker, RefinedLevel& out,
                                  const RunControl& control) {
  do {
    rounds_.refine(*measured_, task, out, control);
  } while (separate_intersections(tracker, out, control));
}

// A new covering would not know these cells.
void Refiner::save_inserted_in() {
  const Covering& covering = measured_->covering();
  inserted_in_.resize(covering.site_count(), kNone);
  for (CellId c = 0; c < covering.site_count(); ++c) {
    if (inserted_in_[c] == kNone) inserted_in_[c] = covering.inserted_in()[c];
  }
}

// Adds c-vertices and continues on the subdivided surface. Vertices keep their positions: their
// c-vertices are moved there.
void Refiner::subdivide_surface(std::span<const CVertexId> wanted, const RunControl& control) {
  const VertexPlacement& placement = measured_->placement();
  std::vector<CVertexId> displaced;
  std::vector<Vec3> positions = surface_.complex().positions, reverted;
  for (CellId c = 0; c < placement.displacement.size(); ++c) {
    if (placement.displacement[c] == Vec3{}) continue;
    const CVertexId v = placement.anchor[c];
    displaced.push_back(v);
    positions[v] = base_position(surface_.complex(), placement, c);
    reverted.push_back(c < previous_site_count_ ? positions[v] : surface_.complex().positions[v]);
  }
  report_continuing(control);
  std::vector<CVertexId> conflicting_moves =
      surface_.find_conflicting_moves(displaced, reverted, positions, displaced);
  std::sort(conflicting_moves.begin(), conflicting_moves.end());
  for (std::size_t i = 0; i < displaced.size(); ++i)
    surface_.move(displaced[i], std::binary_search(conflicting_moves.begin(),
                                                   conflicting_moves.end(), displaced[i])
                                    ? reverted[i]
                                    : positions[displaced[i]]);
  std::vector<CVertexId> fixed;  // anchors of vertices of earlier levels
  for (CellId c = 0; c < previous_site_count_; ++c) fixed.push_back(placement.anchor[c]);
  surface_.subdivide(wanted, fixed);
  report_continuing(control);
  const std::vector<Vec3> before = measured_->base_points();
  measured_->adapt_to(surface_data_->rebuild(), before, control);
}

// Collects the constraints in their order. Before a limit takes effect, refines for the earlier
// constraints.
// @return the task with all constraints; the last ones are not refined for yet
Refiner::Task Refiner::prepare_task(const LevelGoal& goal, Placement placement, RefinedLevel& out,
                                    const RunControl& control) {
  Task task;
  task.placement = placement;
  ShapeGoal shape;
  bool has_new_targets = false;
  for (const Constraint& c : goal) {
    const bool limit = c.quantity == Quantity::max_vertices || c.quantity == Quantity::min_edge;
    if (limit && has_new_targets) {
      rounds_.refine(*measured_, task, out, control);
    }
    has_new_targets = !limit;
    switch (c.quantity) {
      case Quantity::max_vertices:
        task.max_sites = static_cast<std::uint32_t>(std::min(c.bound, 4e9));
        break;
      case Quantity::min_vertices:
        task.min_sites = static_cast<std::uint32_t>(std::min(std::ceil(c.bound), 4e9));
        break;
      case Quantity::min_edge:
        task.min_edge = static_cast<float>(c.bound);
        break;
      case Quantity::min_aspect:
        shape = ShapeGoal::of(c.bound);
        task.shape = shape;
        break;
      default:
        task.metrics.push_back(c);
    }
  }
  task.shape = shape;
  const auto bound = ranges::find(task.metrics, Quantity::max_distance, &Constraint::quantity);
  if (bound != task.metrics.end() && task.metrics.size() == 1)
    task.useful_radius = static_cast<float>(kUsefulShare * bound->bound);
  return task;
}

// Cells that violate a bound, with their excess, the worst first.
std::vector<std::pair<CellId, double>> Refiner::violating_cells(
    const LevelGoal& requested, std::span<const MetricValues> values) const {
  std::vector<std::pair<CellId, double>> out;
  for (CellId c = 0; c < values.size(); ++c) {
    double excess = 0;
    for (const Constraint& m : requested) {
      if (!drives_refinement(m.quantity)) continue;
      const double value =
          is_metric(m.quantity) ? values[c][static_cast<std::size_t>(m.quantity)]
          : m.custom ? custom_value(*m.custom, surface_data_->surfels, measured_->mesh(), c)
                     : longest_edge(measured_->mesh(), c);
      excess = std::max(excess, excess_of(m.quantity, value, m.bound));
    }
    if (excess > 1) out.emplace_back(c, excess);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return out;
}

// The c-vertices of the cells' sites and their neighbours, in the order of the cells, up to a
// limit: if the surface is at the resolution limit nearly everywhere, a finer volume is needed.
std::vector<CVertexId> Refiner::c_vertices_near(
    std::span<const std::pair<double, CellId>> cells) const {
  const std::size_t room = std::max<std::size_t>(
      kMinSubdivided, surface_.complex().c_vertex_count() / kSubdividedDivisor);
  std::vector<std::uint8_t> is_taken(surface_.complex().c_vertex_count(), 0);
  std::vector<CVertexId> out;
  const auto take = [&](CVertexId v) {
    if (std::exchange(is_taken[v], std::uint8_t{1}) == 0) out.push_back(v);
  };
  for (const auto& [excess, c] : cells) {
    if (out.size() >= room) break;
    const CVertexId v = partition().site[c];
    take(v);
    for (const CVertexGraph::Neighbour& n : surface_data_->graph.row(v)) take(n.id);
  }
  std::sort(out.begin(), out.end());
  return out;
}

// Cells that violate a bound and cannot become smaller, with negated excess, the worst first.
std::vector<std::pair<double, CellId>> Refiner::cells_at_limit(const Task& task) {
  std::vector<CellId> cells;
  for (CellId c = 0; c < partition().cell_count(); ++c) {
    if (measured_->errors()[c].excess > 1 && is_at_limit(task, c)) cells.push_back(c);
  }
  measured_->complete_errors(cells);
  std::vector<std::pair<double, CellId>> out;
  for (const CellId c : cells) out.emplace_back(-measured_->errors()[c].excess, c);
  std::sort(out.begin(), out.end());
  return out;
}

// A cell on a shared face is a single c-vertex. Refinement ends only if the cells around it cannot
// become smaller either.
bool Refiner::is_at_limit(const Task& task, CellId c) const {
  const CVertexId v = partition().site[c];
  if (surface_data_->is_on_shared_face(v)) return true;
  return measured_->covering().radius()[v] <=
         std::max(kLimitShare * surface_data_->farthest_neighbour[v], task.useful_radius) * 1.0001f;
}

// Refines for the task, and subdivides the surface where it has too few c-vertices.
void Refiner::refine_with_subdivision(const Task& task, IntersectionTracker& tracker,
                                      RefinedLevel& out, const RunControl& control) {
  const auto refine_task = [&] {
    if (output_positions_) {
      refine_and_separate(task, tracker, out, control);
    } else {
      rounds_.refine(*measured_, task, out, control);
    }
  };
  refine_task();
  // Balance all vertices at once instead of piece by piece, then refine where this increased
  // errors.
  for (int balance_round = 0; task.placement == Placement::balanced &&
                              balance_round < kMaxBalanceRounds && !out.vertex_limit_reached;
       ++balance_round) {
    const std::uint32_t sites = partition().cell_count();
    measured_->update_all(out.certificate, control);
    refine_task();
    if (partition().cell_count() == sites) break;
  }
  const auto subdivide_and_refine = [&] {
    double before = std::numeric_limits<double>::infinity(),
           worst_before = before;  // number of violating cells and their largest excess
    for (; subdivisions_ < max_subdivisions_ && !out.vertex_limit_reached; ++subdivisions_) {
      const std::vector<std::pair<double, CellId>> cells = cells_at_limit(task);
      if (cells.empty()) break;
      const auto count = static_cast<double>(cells.size());
      const double worst = -cells.front().first;
      if (count > (worst < worst_before ? kMaxRemainingShare : kFewRemaining) * before) break;
      before = count;
      worst_before = worst;
      const std::vector<CVertexId> wanted = c_vertices_near(cells);
      subdivide_surface(wanted, control);
      refine_task();
    }
  };
  subdivide_and_refine();
  prove(task, [&] {
    refine_task();
    subdivide_and_refine();
  });
}

// Proves the bound once all samples satisfy it. Where a proof fails, cells become smaller, a
// limited number of times per level.
void Refiner::prove(const Task& task, const std::function<void()>& refine_again) {
  was_proved_ = false;
  if (!is_provable(task) || !measured_->is_within_bounds()) return;
  for (; proofs_ < kMaxFailedProofs && measured_->prove() > 0; ++proofs_) refine_again();
  was_proved_ = measured_->is_proved();
}

// A default bound is not worth the time of a proof.
bool Refiner::is_provable(const Task& task) const {
  const auto is_requested = [](const Constraint& c) {
    return c.quantity == Quantity::max_distance && !c.is_default;
  };
  return start_.is_complete && task.max_sites == kNone &&
         ranges::any_of(task.metrics, is_requested);
}

struct Refiner::State {
  AdaptiveSurface surface;
  std::shared_ptr<const MeasuredCovering> measured;  // refers to the surface data of `surface`
  std::vector<CellId> inserted_in;
  MeshStatistics statistics;
  std::array<MetricSummary, kMetricCount> metrics;
};

std::shared_ptr<const Refiner::State> Refiner::save_state() const {
  return std::make_shared<const State>(
      State{surface_, measured_ ? std::make_shared<const MeasuredCovering>(*measured_) : nullptr,
            inserted_in_, statistics_, metrics_});
}

void Refiner::restore_state(const State& state) {
  surface_ = state.surface;
  surface_data_->rebuild();
  measured_ = state.measured ? std::make_unique<MeasuredCovering>(*state.measured) : nullptr;
  inserted_in_ = state.inserted_in;
  statistics_ = state.statistics;
  metrics_ = state.metrics;
}

RefinedLevel Refiner::unchanged_level(const LevelGoal& requested) const {
  RefinedLevel same;
  same.unchanged_from_previous_level = true;
  same.figures = {metrics_,
                  evaluate_constraints(requested, statistics_, metrics_, custom_maxima(),
                                       {&statistics_, is_first_refined_, true, false, 0}),
                  {},
                  {}};
  return same;
}

// Well below a voxel smaller cells are not always better: once all are as small as possible, the
// largest distance depends on chance. So if a tight bound is not satisfied, all of kLooserBounds
// above it are tried from the same start. This guarantees that a tight bound never gives a larger
// distance than one of these looser bounds would have. (Two bounds between them may still differ by
// chance.)
RefinedLevel Refiner::refine(const LevelGoal& goal, Placement placement,
                             const RunControl& control) {
  is_first_refined_ = measured_ == nullptr;
  if (!is_first_refined_) previous_site_count_ = partition().cell_count();
  const double bound = tight_distance(goal);
  if (bound == 0) return refine_once(goal, goal, placement, control);

  const auto reached = [](const RefinedLevel& level) {
    return level.figures.metrics[kMaxDistance].maximum;
  };
  const std::shared_ptr<const State> start = save_state();
  RefinedLevel best = refine_once(goal, goal, placement, control);
  if (reached(best) <= bound) return best;
  std::shared_ptr<const State> state_of_best = save_state();
  for (const double looser : kLooserBounds) {
    if (looser <= bound) break;
    restore_state(*start);
    RefinedLevel other = refine_once(with_distance(goal, looser), goal, placement, control);
    if (other.unchanged_from_previous_level || reached(other) >= reached(best)) continue;
    best = std::move(other);
    state_of_best = save_state();
  }
  const bool was_better = !is_first_refined_ && goal.size() == 1 &&
                          start->metrics[kMaxDistance].maximum <= reached(best);
  restore_state(was_better ? *start : *state_of_best);
  return was_better ? unchanged_level(goal) : best;
}

// @param goal       the bounds to refine for
// @param requested  the bounds that are reported
RefinedLevel Refiner::refine_once(const LevelGoal& goal, const LevelGoal& requested,
                                  Placement placement, const RunControl& control) {
  RefinedLevel out;
  subdivisions_ = 0;
  rounds_ = {};
  proofs_ = 0;
  if (is_limited(goal) && static_cast<double>(previous_site_count_) >= goal.front().bound)
    return unchanged_level(requested);
  if (measured_ == nullptr) {
    refine_coarser_complex(goal, placement, out, control);
  } else {
    restart_with_sites_at_vertices(control);
  }
  save_inserted_in();
  IntersectionTracker tracker(output_positions_.value_or(OutputPositions()));
  Task task = prepare_task(goal, placement, out, control);
  if (!is_limited(goal)) {
    lower_predicted_radii(task, out, control);
    refine_with_subdivision(task, tracker, out, control);
  } else if (!refine_within_budget(task, goal.front().bound, tracker, out, control)) {
    return unchanged_level(requested);
  }
  finish(task, requested, tracker, out, control);
  return out;
}

// Makes most of the cells that a bound on the distance requires at once, where cells violate it;
// rounds would double the number of cells each time and would cover and measure all of them several
// times. Not used with a limit on vertices, since these belong where the mesh is farthest.
void Refiner::lower_predicted_radii(const Task& task, RefinedLevel& out,
                                    const RunControl& control) {
  const auto bound = ranges::find(task.metrics, Quantity::max_distance, &Constraint::quantity);
  if (task.max_sites != kNone || bound == task.metrics.end()) return;
  measured_->set_bounds(relaxed_bounds(task.metrics), task.placement);
  measured_->update(out.certificate, control);
  std::vector<CVertexId> at;
  const auto add = [&](CVertexId v) {
    if (measured_->errors()[partition().cell_of[v]].excess > 1) at.push_back(v);
  };
  for (const CVertexId v : coarser_.representative) add(v);
  if (coarser_.representative.empty()) {
    for (CVertexId v = 0; v < partition().cell_of.size(); ++v) add(v);
  }
  std::vector<Covering::Radius> radii = predict_radii(*surface_data_, at, bound->bound);
  for (Covering::Radius& r : radii)
    r.radius = std::max(r.radius, min_useful_radius(task, *surface_data_, r.at));
  measured_->covering().lower_radii(radii, control);
}

bool Refiner::refine_at(std::span<const Triangle> triangles, const LevelGoal& goal,
                        Placement placement, RefinedLevel& level, const RunControl& control) {
  std::vector<CellId> cells;
  for (const Triangle& t : triangles) cells.insert(cells.end(), t.begin(), t.end());
  ranges::sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  if (!can_refine(cells)) return false;
  subdivisions_ = 0;
  measured_->fix_anchors(previous_site_count_);
  restart_with_sites_at_vertices(control);
  refine_cells(cells, control);
  const Task task = prepare_task(goal, placement, level, control);
  IntersectionTracker tracker(output_positions_.value_or(OutputPositions()));
  refine_with_subdivision(task, tracker, level, control);
  level.at_limit.clear();
  finish(task, goal, tracker, level, control);
  return true;
}

// Makes all vertices movable, all edges flippable, and allows cells as small as their vertices
// permit.
void Refiner::restart_with_sites_at_vertices(const RunControl& control) {
  measured_->clear_fixed();
  if (measured_->placement().anchor != partition().site) subdivide_surface({}, control);
}

// Topology, and avoiding intersections, may need more vertices than are left. Then the last sites
// are removed until the limit is satisfied.
// @return false if no level with more vertices than the previous one satisfies it
bool Refiner::refine_within_budget(Task& task, double most, IntersectionTracker& tracker,
                                   RefinedLevel& out, const RunControl& control) {
  const std::uint32_t start = partition().cell_count();
  refine_with_subdivision(task, tracker, out, control);
  double kept = most;
  for (double times = 1; partition().cell_count() > most; times *= 2) {
    kept = std::floor(kept - times * (partition().cell_count() - most));
    const bool has_room = kept > start;
    remove_sites(has_room ? static_cast<std::uint32_t>(kept) : start, control);
    if (!has_room && !is_first_refined_) return false;
    task.max_sites = partition().cell_count();
    out.vertex_limit_reached = true;
    measured_->update(out.certificate, control);
    if (output_positions_) separate_intersections(tracker, out, control);
    if (!has_room) break;
  }
  return true;
}

void Refiner::remove_sites(std::uint32_t count, const RunControl& control) {
  measured_->remove_sites(count, control);
  inserted_in_.resize(std::min<std::size_t>(inserted_in_.size(), count));
}

// Completes the level's triangles: improves their shape, resolves self-intersections and describes
// the result.
void Refiner::finish(const Task& task, const LevelGoal& requested, IntersectionTracker& tracker,
                     RefinedLevel& out, const RunControl& control) {
  measured_->certify(out.certificate, control);
  std::vector<DualTriangle> triangles;
  improve_level_shape(task, triangles, out, control);
  retry_bad_triangles(task, tracker, triangles, out, control);
  control.report("refine", kShapeShare);
  repair_worst_cells(task, triangles, out, control);
  if (output_positions_) revert_intersecting_changes(task, tracker, triangles, out, control);
  prove_changes(task, tracker, triangles, out, control);
  out.figures.distance_at_most =
      is_provable(task) && measured_->is_proved() ? measured_->distance_bound() : std::nullopt;
  measured_->fix_anchors(partition().cell_count());
  out.triangles = to_triangles(triangles);
  report_continuing(control);
  describe(task, requested, out);
}

void Refiner::improve_level_shape(const Task& task, std::vector<DualTriangle>& triangles,
                                  RefinedLevel& out, const RunControl& control) {
  const std::size_t moves = out.shape.moves,
                    displacements =
                        out.shape.displacements;  // moves and displacements remain, flips do not
  out.shape = improve_shape(*measured_, *task.shape, triangles, control);
  out.shape.moves += moves;
  out.shape.displacements += displacements;
}

void Refiner::refine_and_improve(const Task& task, IntersectionTracker& tracker,
                                 std::vector<DualTriangle>& triangles, RefinedLevel& out,
                                 const RunControl& control) {
  refine_with_subdivision(task, tracker, out, control);
  measured_->certify(out.certificate, control);
  improve_level_shape(task, triangles, out, control);
}

// Where neither a flip nor a move improves a triangle, smaller cells around it yield another mesh,
// which is improved again.
void Refiner::retry_bad_triangles(const Task& task, IntersectionTracker& tracker,
                                  std::vector<DualTriangle>& triangles, RefinedLevel& out,
                                  const RunControl& control) {
  std::size_t fewest = out.shape.bad;
  int vain_retries = 0;
  for (int retry = 0; retry < kMaxRetries && vain_retries < kMaxVainRetries && out.shape.bad > 0 &&
                      out.shape.bad < kMaxRetriedTriangles;
       ++retry) {
    if (task.max_sites != kNone || !shrink_cells_at_bad_triangles(*measured_, task, triangles))
      break;
    refine_and_improve(task, tracker, triangles, out, control);
    const bool has_helped =
        static_cast<double>(out.shape.bad) <= (1 - kMinRetryGain) * static_cast<double>(fewest);
    vain_retries = has_helped ? 0 : vain_retries + 1;
    fewest = std::min(fewest, out.shape.bad);
  }
}

// Improves the worst of the cells at the resolution limit by flips and moves.
void Refiner::repair_worst_cells(const Task& task, std::vector<DualTriangle>& triangles,
                                 RefinedLevel& out, const RunControl& control) {
  std::vector<std::pair<double, CellId>> worst = cells_at_limit(task);
  if (worst.size() > kMaxRepairedCells) worst.resize(kMaxRepairedCells);
  std::vector<CellId> to_repair;
  for (const auto& [excess, c] : worst) to_repair.push_back(c);
  improve_errors(*measured_, *task.shape, to_repair, triangles, out.shape, control);
}

void Refiner::revert_intersecting_changes(const Task& task, IntersectionTracker& tracker,
                                          std::vector<DualTriangle>& triangles, RefinedLevel& out,
                                          const RunControl& control) {
  for (int k = 0; !revert_intersecting(*measured_, tracker, triangles, control).empty(); ++k) {
    if (k == kMaxRetries) {  // the dual itself has no self-intersections
      revert_all(*measured_, triangles, control);
      break;
    }
    refine_and_improve(task, tracker, triangles, out, control);
    repair_worst_cells(task, triangles, out, control);
  }
  improve_shape_without_intersections(*measured_, *task.shape, tracker, triangles, out.shape,
                                      control);
  revert_until_embedded(tracker, triangles, out, control);
}

// Reverting a change does not undo what balancing has done since, and c-vertices may intersect
// without the others of a reverted group.
void Refiner::revert_until_embedded(IntersectionTracker& tracker,
                                    std::vector<DualTriangle>& triangles, RefinedLevel& out,
                                    const RunControl& control) {
  do {
    if (!revert_intersecting(*measured_, tracker, triangles, control).empty()) {
      revert_all(*measured_, triangles, control);
      refine_and_separate({}, tracker, out, control);
      measured_->certify(out.certificate, control);
      triangles.assign(measured_->triangles().begin(), measured_->triangles().end());
    }
  } while (revert_conflicting_moves(*measured_, triangles, control));
}

// Changes for shape were tested at samples only. If the bound was proved before, they are reverted
// where it cannot be proved with them.
void Refiner::prove_changes(const Task& task, IntersectionTracker& tracker,
                            std::vector<DualTriangle>& triangles, RefinedLevel& out,
                            const RunControl& control) {
  for (int k = 0; is_provable(task) && measured_->is_within_bounds(); ++k) {
    // balancing moves vertices without testing all triangles around them
    if (task.placement == Placement::balanced) measured_->clear_proofs();
    if (measured_->prove() == 0 || !was_proved_ || k == kMaxRetries) break;
    std::vector<CellId> failed;
    for (CellId c = 0; c < partition().cell_count(); ++c) {
      if (measured_->errors()[c].excess > 1) failed.push_back(c);
    }
    if (!revert_at(*measured_, failed, triangles, control)) break;
    if (output_positions_) revert_until_embedded(tracker, triangles, out, control);
  }
}

// Fills in the figures of the level, for the constraints as requested.
void Refiner::describe(const Task& task, const LevelGoal& requested, RefinedLevel& out) {
  const std::vector<MetricValues> values = measured_->measure_metrics();
  Obstacles obstacles{&statistics_, is_first_refined_, out.vertex_limit_reached, false, 0};
  for (const auto& [c, excess] : violating_cells(requested, values)) {
    const float radius = measured_->covering().radius()[partition().site[c]];
    if (is_at_limit(task, c)) {
      out.at_limit.emplace_back(c, excess);
    } else if (radius <= kChordSlack * task.min_edge * 1.0001f) {
      obstacles.blocked_by_min_edge = true;
    }
  }
  obstacles.cells_at_limit = out.at_limit.size();
  out.figures.metrics = summarize(values);
  out.figures.distance = distances(values);
  surface_data_->check_cancelled();
  MeshStatistics statistics = mesh_statistics(measured_->mesh());
  out.figures.constraints =
      evaluate_constraints(requested, statistics, out.figures.metrics, custom_maxima(), obstacles);
  statistics_ = std::move(statistics);
  metrics_ = out.figures.metrics;
}

LevelMesh Refiner::coarse_mesh(const Covering& covering, const RunControl* control) const {
  std::vector<DualTriangle> dual;
  dual.reserve(coarse_triangles_.size());
  for (const Triangle& t : coarse_triangles_) dual.push_back({t, kNone});
  return make_level_mesh(surface_data_->surfels, covering.partition(), dual, start_.placement,
                         control);
}

// Of the last level: before the first refined one, of the coarse one.
CustomMaximum Refiner::custom_maxima() const {
  return [this](const CustomMetric& metric) {
    if (measured_) return custom_maximum(metric, surface_data_->surfels, measured_->mesh());
    Covering covering(surface_data_->graph, options_);
    covering.seed(start_.placement.anchor, {}, {});
    return custom_maximum(metric, surface_data_->surfels, coarse_mesh(covering, nullptr));
  };
}

LevelFigures Refiner::describe_coarse(std::span<const Triangle> triangles, const LevelGoal& goal,
                                      const RunControl& control) {
  control.check_cancelled();
  coarse_triangles_.assign(triangles.begin(), triangles.end());
  Covering covering(surface_data_->graph, options_);
  covering.seed(start_.placement.anchor, {}, control);
  control.check_cancelled();
  const LevelMesh mesh = coarse_mesh(covering, &control);
  control.check_cancelled();
  statistics_ = mesh_statistics(mesh);
  const std::vector<MetricValues> values = measure_metrics(*surface_data_, covering, mesh);
  metrics_ = summarize(values);
  return {metrics_,
          evaluate_constraints(goal, statistics_, metrics_, custom_maxima(), {}),
          distances(values),
          {}};
}

std::vector<std::uint32_t> Refiner::parents() const {
  std::vector<std::uint32_t> out(measured_->covering().inserted_in());
  for (std::uint32_t c = 0; c < out.size(); ++c) {
    if (c < inserted_in_.size() && inserted_in_[c] != kNone) out[c] = inserted_in_[c];
    if (c < previous_site_count_ || out[c] == kNone) {
      out[c] = c;
    } else {
      while (out[c] >= previous_site_count_)
        out[c] = out[out[c]];  // inserted in the cell of a vertex that is new as well
    }
  }
  return out;
}

}  // namespace isoatlas::detail
