// SPDX-License-Identifier: Apache-2.0
// Stage two: adaptive refinement.
//
// Based on:
//   [gavriliu2001]  sections 3.4 and 3.5, figure 8.
//   [boissonnat2005]  Provably good sampling and meshing of surfaces (a new vertex where the mesh is farthest from the surface).
// Ours: steps finer than halving, priorities between soft constraints, shape as a reason to refine (docs/theory/05-refinement.md).
#include "levels/refiner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "embedding/resolve_intersections.h"
#include "levels/predict_radii.h"

namespace isoatlas::detail {
namespace {

// On the coarser complex, whose c-vertices are few, stop well above its own limit: the surface itself places sites better.
constexpr float kCoarserLimitShare = 2;

constexpr int kMostLastLooks = 3;
constexpr int kMostProofs = 10;
// Of the time of a level, that goes by until its triangles' shape has been worked on.
constexpr double kShapeShare = 0.85;
// A few bad triangles that are left get so many more chances, but only so many in a row that mend less than this share of them.
constexpr int kMostChances = 6, kMostInVain = 2;
constexpr double kWorthAChance = 0.05;
constexpr std::size_t kFewTriangles = 100;
// Cells at their limit that are tried to be mended by flips and moves.
constexpr std::size_t kMostMended = 200;
// A cell with a radius of this share of a bound on the distance lies within the bound, but for what vertices are away from the surface:
// what is farther there, smaller cells do not mend.
constexpr double kUsefulShare = 0.4;
// Each time that the surface is divided for a bound, the faces around so many c-vertices, or around this part of them all.
constexpr std::size_t kFewDivided = 6, kShareDivided = 20;
// The surface is subdivided again while at most kWorthDividing of the violating cells are left and the worst of them violates the bound
// less than before, or while at most kFewLeft of them are left.
constexpr double kWorthDividing = 0.75, kFewLeft = 0.1;

// @param to  what each c-vertex is on another complex; empty: on the same one
std::vector<Covering::Radius> radii_of(std::span<const float> radius, std::span<const CVertexId> to) {
  std::vector<Covering::Radius> out;
  out.reserve(radius.size());
  for (CVertexId v = 0; v < radius.size(); ++v) out.push_back({to.empty() ? v : to[v], radius[v]});
  return out;
}

std::vector<float> distances(std::span<const MetricValues> values) {
  std::vector<float> out;
  out.reserve(values.size());
  for (const MetricValues& v : values) out.push_back(static_cast<float>(v[static_cast<std::size_t>(Quantity::max_distance)]));
  return out;
}

bool drives(Quantity q) { return is_metric(q) || q == Quantity::max_edge; }

bool is_limited(const LevelGoal& goal) { return !goal.empty() && goal.front().quantity == Quantity::max_vertices; }

constexpr auto kMaxDistance = static_cast<std::size_t>(Quantity::max_distance);
// In voxels: the bounds that are tried as well where a tighter one cannot be met.
constexpr std::array kLooserBounds{0.5, 0.4, 0.32, 0.256};

// The bound on the distance if somebody asked for a tight one before all else, and for no limit on vertices; else 0.
double tight_distance(const LevelGoal& goal) {
  if (std::ranges::find(goal, Quantity::max_vertices, &Constraint::quantity) != goal.end()) return 0;
  const bool is_tight = !goal.empty() && goal.front().quantity == Quantity::max_distance && !goal.front().is_default &&
                        goal.front().bound < kLooserBounds.front();
  return is_tight ? goal.front().bound : 0;
}

LevelGoal with_distance(LevelGoal goal, double bound) {
  for (Constraint& c : goal) {
    if (c.quantity == Quantity::max_distance) c.bound = bound;
  }
  return goal;
}

}  // namespace

Refiner::Refiner(AdaptiveSurface& surface, const Isosurface& isosurface, const Coarsened& coarser, const CoveringOptions& options,
                 Start start, std::optional<WrittenPositions> embedded, std::uint32_t most_divisions)
    : options_(options),
      surface_(surface),
      isosurface_(isosurface),
      coarser_(coarser),
      start_(std::move(start)),
      embedded_(std::move(embedded)),
      most_divisions_(most_divisions),
      surface_data_(std::make_unique<SurfaceData>(surface.complex(), &isosurface, &surface)),
      sites_before_(static_cast<std::uint32_t>(start_.placement.anchor.size())) {}

void Refiner::step_down(const LevelGoal& goal, Placement placement, RefinedLevel& out, const RunControl& control) {
  const std::vector<CVertexId>& on = coarser_.representative;
  std::vector<CVertexId> sites = start_.placement.anchor;
  std::vector<Covering::Radius> radii;
  if (on.empty()) {
    radii = radii_of(start_.radius, {});
  } else {
    const SurfaceData surface_data(coarser_.complex, nullptr, nullptr, &control);
    MeasuredCovering rough(surface_data, options_, start_.site, radii_of(start_.radius, {}), control);
    Task task;
    task.placement = placement;
    task.limit_share = kCoarserLimitShare;
    for (const Constraint& c : goal) {
      if (drives(c.quantity)) task.metrics.push_back(c);
      // Leave room for what the surface itself will ask for.
      if (c.quantity == Quantity::max_vertices) task.most_sites = static_cast<std::uint32_t>(0.6 * std::min(c.bound, 4e9));
      if (c.quantity == Quantity::min_edge) task.shortest_edge = static_cast<float>(c.bound);
    }
    if (!task.metrics.empty() && rough.covering().site_count() < task.most_sites) {
      rounds_.work(rough, task, out, control);
      out.vertices_ran_out = false;  // only its share of them
    }
    inserted_in_ = rough.covering().inserted_in();
    sites.clear();
    for (const CVertexId v : rough.partition().site) sites.push_back(on[v]);
    radii = radii_of(rough.covering().radius(), on);
  }
  work_ = std::make_unique<MeasuredCovering>(*surface_data_, options_, sites, radii, control);
  work_->set_displacement(start_.placement.displacement);
  work_->fix_anchors(sites_before_);
}

// @return whether any of the cells is divided, or the surface there
bool Refiner::refine_cells(std::span<const CellId> cells, const RunControl& control) {
  const std::vector<CellId> single = work_->covering().shrink(cells);
  if (single.size() < cells.size()) return true;  // the surface only where nothing else helps
  return subdivide(single, control);
}

// The surface at cells that are single c-vertices. @return whether that could be done
bool Refiner::subdivide(std::span<const CellId> single, const RunControl& control) {
  const std::vector<CVertexId> wanted = filter_subdividable(surface_, sites_of(single));
  if (!wanted.empty()) divide_surface(wanted, control);
  return !wanted.empty();
}

std::vector<CVertexId> Refiner::sites_of(std::span<const CellId> cells) const {
  std::vector<CVertexId> out;
  for (const CellId c : cells) out.push_back(partition().site[c]);
  return out;
}

// Whether refine_cells() would do anything.
bool Refiner::can_refine(std::span<const CellId> cells) const {
  std::vector<CellId> single;
  for (const CellId c : cells) {
    if (work_->mesh().c_vertices_of.row(c).size() == 1) single.push_back(c);
  }
  return single.size() < cells.size() || !filter_subdividable(surface_, sites_of(single)).empty();
}

// A refined level while its self-intersections are resolved.
class Refiner::Dual : public GrowingDual {
 public:
  Dual(Refiner& refiner, CertificateReport& certificate, const RunControl& control)
      : refiner_(refiner), certificate_(certificate), control_(control) {}

  Covering& covering() override { return refiner_.work_->covering(); }
  void update() override { refiner_.work_->update(certificate_, control_); }
  std::vector<Vec3> positions() const override { return refiner_.work_->positions(); }
  std::vector<Triangle> triangles() const override { return to_triangles(refiner_.work_->triangles()); }
  std::vector<CVertexId> sites_on_surface() const override { return refiner_.partition().site; }
  bool subdivide(std::span<const CellId> single) override {
    update();  // cells that are not single ones have become smaller
    return refiner_.subdivide(single, control_);
  }

 private:
  Refiner& refiner_;
  CertificateReport& certificate_;
  const RunControl& control_;
};

// @return whether anything has changed
bool Refiner::separate_intersections(IntersectionTracker& meeting, RefinedLevel& out, const RunControl& control) {
  const std::uint32_t sites = partition().cell_count();
  Dual dual(*this, out.certificate, control);
  const bool any = resolve_intersections(dual, surface_, meeting, control).has_changed;
  out.parting_sites += partition().cell_count() - sites;
  return any;
}

// Works on the task until there are no self-intersections either.
void Refiner::work_apart(const Task& task, IntersectionTracker& meeting, RefinedLevel& out, const RunControl& control) {
  do {
    rounds_.work(*work_, task, out, control);
  } while (separate_intersections(meeting, out, control));
}

// Which a covering that is made anew does not know.
void Refiner::remember_placed_in() {
  const Covering& covering = work_->covering();
  inserted_in_.resize(covering.site_count(), kNone);
  for (CellId c = 0; c < covering.site_count(); ++c) {
    if (inserted_in_[c] == kNone) inserted_in_[c] = covering.inserted_in()[c];
  }
}

// More c-vertices, on which the same work goes on. Vertices stay where they are: there are their c-vertices from now on.
void Refiner::divide_surface(std::span<const CVertexId> wanted, const RunControl& control) {
  const VertexPlacement& placement = work_->placement();
  std::vector<CVertexId> movers;
  std::vector<Vec3> positions = surface_.complex().positions, frozen;
  for (CellId c = 0; c < placement.displacement.size(); ++c) {
    if (placement.displacement[c] == Vec3{}) continue;
    const CVertexId v = placement.anchor[c];
    movers.push_back(v);
    positions[v] = base_position(surface_.complex(), placement, c);
    frozen.push_back(c < sites_before_ ? positions[v] : surface_.complex().positions[v]);
  }
  report_going_on(control);
  std::vector<CVertexId> conflicting_moves = surface_.find_conflicting_moves(movers, frozen, positions, movers);
  std::sort(conflicting_moves.begin(), conflicting_moves.end());
  for (std::size_t i = 0; i < movers.size(); ++i)
    surface_.move(movers[i],
                  std::binary_search(conflicting_moves.begin(), conflicting_moves.end(), movers[i]) ? frozen[i] : positions[movers[i]]);
  std::vector<CVertexId> pinned;  // by vertices of earlier levels
  for (CellId c = 0; c < sites_before_; ++c) pinned.push_back(placement.anchor[c]);
  surface_.subdivide(wanted, pinned);
  report_going_on(control);
  const std::vector<Vec3> before = work_->base_points();
  work_->adapt_to(surface_data_->rebuild(), before, control);
}

// The constraints in their order: works on what there is so far before a limit comes into force.
// @return all of them, the last ones still to be worked on
Refiner::Task Refiner::whole_task(const LevelGoal& goal, Placement placement, RefinedLevel& out, const RunControl& control) {
  Task task;
  task.placement = placement;
  ShapeGoal shape;
  bool new_aims = false;
  for (const Constraint& c : goal) {
    const bool limit = c.quantity == Quantity::max_vertices || c.quantity == Quantity::min_edge;
    if (limit && new_aims) {
      rounds_.work(*work_, task, out, control);
    }
    new_aims = !limit;
    switch (c.quantity) {
      case Quantity::max_vertices:
        task.most_sites = static_cast<std::uint32_t>(std::min(c.bound, 4e9));
        break;
      case Quantity::min_vertices:
        task.least_sites = static_cast<std::uint32_t>(std::min(std::ceil(c.bound), 4e9));
        break;
      case Quantity::min_edge:
        task.shortest_edge = static_cast<float>(c.bound);
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
  const auto bound = std::ranges::find(task.metrics, Quantity::max_distance, &Constraint::quantity);
  if (bound != task.metrics.end() && task.metrics.size() == 1) task.useful_radius = static_cast<float>(kUsefulShare * bound->bound);
  return task;
}

// Cells over a bound with how far they are over it, the worst first.
std::vector<std::pair<CellId, double>> Refiner::cells_over(const LevelGoal& asked, std::span<const MetricValues> values) const {
  std::vector<std::pair<CellId, double>> out;
  for (CellId c = 0; c < values.size(); ++c) {
    double excess = 0;
    for (const Constraint& m : asked) {
      if (!drives(m.quantity)) continue;
      const double value = is_metric(m.quantity) ? values[c][static_cast<std::size_t>(m.quantity)] : longest_edge(work_->mesh(), c);
      excess = std::max(excess, excess_of(m.quantity, value, m.bound));
    }
    if (excess > 1) out.emplace_back(c, excess);
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  return out;
}

// The c-vertices of cells and their neighbours, in the order of the cells, up to a limit: a surface that is at its limit nearly everywhere
// needs another volume.
std::vector<CVertexId> Refiner::places_at(std::span<const std::pair<double, CellId>> cells) const {
  const std::size_t room = std::max<std::size_t>(kFewDivided, surface_.complex().c_vertex_count() / kShareDivided);
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

// Cells over a bound that cannot be made smaller, with minus their excess, the worst first.
std::vector<std::pair<double, CellId>> Refiner::cells_at_limit(const Task& task) {
  std::vector<CellId> cells;
  for (CellId c = 0; c < partition().cell_count(); ++c) {
    if (work_->errors()[c].excess > 1 && is_at_limit(task, c)) cells.push_back(c);
  }
  work_->complete_errors(cells);
  std::vector<std::pair<double, CellId>> out;
  for (const CellId c : cells) out.emplace_back(-work_->errors()[c].excess, c);
  std::sort(out.begin(), out.end());
  return out;
}

bool Refiner::is_at_limit(const Task& task, CellId c) const {
  const CVertexId v = partition().site[c];
  return work_->covering().radius()[v] <= std::max(kLimitShare * surface_data_->farthest_neighbour[v], task.useful_radius) * 1.0001f;
}

// Works on the task, dividing the surface where it has too few c-vertices for that.
void Refiner::work_towards(const Task& task, IntersectionTracker& meeting, RefinedLevel& out, const RunControl& control) {
  const auto once = [&] {
    if (embedded_) {
      work_apart(task, meeting, out, control);
    } else {
      rounds_.work(*work_, task, out, control);
    }
  };
  once();
  // Balanced once more in one go, instead of piece by piece, and then what got worse by that.
  for (int again = 0; task.placement == Placement::balanced && again < kMostLastLooks && !out.vertices_ran_out; ++again) {
    const std::uint32_t sites = partition().cell_count();
    work_->update_all(out.certificate, control);
    once();
    if (partition().cell_count() == sites) break;
  }
  const auto divide = [&] {
    double before = std::numeric_limits<double>::infinity(), worst_before = before;  // how many cells, and the worst excess
    for (; divisions_ < most_divisions_ && !out.vertices_ran_out; ++divisions_) {
      const std::vector<std::pair<double, CellId>> cells = cells_at_limit(task);
      if (cells.empty()) break;
      const auto count = static_cast<double>(cells.size());
      const double worst = -cells.front().first;
      if (count > (worst < worst_before ? kWorthDividing : kFewLeft) * before) break;
      before = count;
      worst_before = worst;
      const std::vector<CVertexId> wanted = places_at(cells);
      divide_surface(wanted, control);
      once();
    }
  };
  divide();
  prove(task, [&] {
    once();
    divide();
  });
}

// What is too far away at a sample needs no proof. Where a proof fails, cells become smaller, some times in a level.
void Refiner::prove(const Task& task, const std::function<void()>& work_on) {
  if (!is_provable(task) || !work_->is_within_bounds()) return;
  for (; proofs_ < kMostProofs && work_->prove() > 0; ++proofs_) work_on();
}

// A bound that nobody asked for is not worth the time.
bool Refiner::is_provable(const Task& task) const {
  const auto is_asked = [](const Constraint& c) { return c.quantity == Quantity::max_distance && !c.is_default; };
  return start_.is_whole && task.most_sites == kNone && std::ranges::any_of(task.metrics, is_asked);
}

struct Refiner::State {
  AdaptiveSurface surface;
  std::shared_ptr<const MeasuredCovering> work;  // on the ground of this surface
  std::vector<CellId> inserted_in;
  MeshExtent extent;
  std::array<MetricSummary, kMetricCount> metrics;
};

std::shared_ptr<const Refiner::State> Refiner::save_state() const {
  return std::make_shared<const State>(
      State{surface_, work_ ? std::make_shared<const MeasuredCovering>(*work_) : nullptr, inserted_in_, extent_, metrics_});
}

void Refiner::restore_state(const State& state) {
  surface_ = state.surface;
  surface_data_->rebuild();
  work_ = state.work ? std::make_unique<MeasuredCovering>(*state.work) : nullptr;
  inserted_in_ = state.inserted_in;
  extent_ = state.extent;
  metrics_ = state.metrics;
}

RefinedLevel Refiner::unchanged_level(const LevelGoal& asked) const {
  RefinedLevel same;
  same.is_the_one_before = true;
  same.figures = {metrics_, judge(asked, extent_, metrics_, {&extent_, is_first_, true, false, 0}), {}, {}};
  return same;
}

// Well below a voxel smaller cells need not be better: where all are as small as they can be, the largest distance is a matter of chance.
// So if a tight bound is not met, all of kLooserBounds above it are tried from the same start, whatever they give: a bound then never leads
// farther from the surface than one of these would, had it been asked for. (Two bounds between them may still differ by chance.)
RefinedLevel Refiner::refine(const LevelGoal& goal, Placement placement, const RunControl& control) {
  is_first_ = work_ == nullptr;
  if (!is_first_) sites_before_ = partition().cell_count();
  const double bound = tight_distance(goal);
  if (bound == 0) return refine_once(goal, goal, placement, control);

  const auto reached = [](const RefinedLevel& level) { return level.figures.metrics[kMaxDistance].maximum; };
  const std::shared_ptr<const State> start = save_state();
  RefinedLevel best = refine_once(goal, goal, placement, control);
  if (reached(best) <= bound) return best;
  std::shared_ptr<const State> state_of_best = save_state();
  for (const double looser : kLooserBounds) {
    if (looser <= bound) break;
    restore_state(*start);
    RefinedLevel other = refine_once(with_distance(goal, looser), goal, placement, control);
    if (other.is_the_one_before || reached(other) >= reached(best)) continue;
    best = std::move(other);
    state_of_best = save_state();
  }
  const bool was_better = !is_first_ && goal.size() == 1 && start->metrics[kMaxDistance].maximum <= reached(best);
  restore_state(was_better ? *start : *state_of_best);
  return was_better ? unchanged_level(goal) : best;
}

// @param goal   what to work for
// @param asked  what the level is judged by
RefinedLevel Refiner::refine_once(const LevelGoal& goal, const LevelGoal& asked, Placement placement, const RunControl& control) {
  RefinedLevel out;
  divisions_ = 0;
  rounds_ = {};
  proofs_ = 0;
  if (is_limited(goal) && static_cast<double>(sites_before_) >= goal.front().bound) return unchanged_level(asked);
  if (work_ == nullptr) {
    step_down(goal, placement, out, control);
  } else {
    restart_at_vertices(control);
  }
  remember_placed_in();
  IntersectionTracker meeting(embedded_.value_or(WrittenPositions()));
  Task task = whole_task(goal, placement, out, control);
  if (!is_limited(goal)) {
    make_predicted_cells(task, out, control);
    work_towards(task, meeting, out, control);
  } else if (!refine_within_budget(task, goal.front().bound, meeting, out, control)) {
    return unchanged_level(asked);
  }
  finish(task, asked, meeting, out, control);
  return out;
}

// Most of what a bound on the distance asks for at once, where the cells are over it: in rounds, each of twice as many cells, all of them
// would be covered and measured several times. Not where vertices may run out, since they belong where the mesh is farthest.
void Refiner::make_predicted_cells(const Task& task, RefinedLevel& out, const RunControl& control) {
  const auto bound = std::ranges::find(task.metrics, Quantity::max_distance, &Constraint::quantity);
  if (task.most_sites != kNone || bound == task.metrics.end()) return;
  work_->set_bounds(demands_of(task.metrics), task.placement);
  work_->update(out.certificate, control);
  std::vector<CVertexId> at;
  const auto add = [&](CVertexId v) {
    if (work_->errors()[partition().cell_of[v]].excess > 1) at.push_back(v);
  };
  std::ranges::for_each(coarser_.representative, add);
  if (coarser_.representative.empty()) {
    for (CVertexId v = 0; v < partition().cell_of.size(); ++v) add(v);
  }
  std::vector<Covering::Radius> radii = predict_radii(*surface_data_, at, bound->bound);
  for (Covering::Radius& r : radii) r.radius = std::max(r.radius, least_useful_radius(task, *surface_data_, r.at));
  work_->covering().lower_radii(radii, control);
}

bool Refiner::refine_at(std::span<const Triangle> triangles, const LevelGoal& goal, Placement placement, RefinedLevel& level,
                        const RunControl& control) {
  std::vector<CellId> cells;
  for (const Triangle& t : triangles) cells.insert(cells.end(), t.begin(), t.end());
  std::ranges::sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  if (!can_refine(cells)) return false;
  divisions_ = 0;
  work_->fix_anchors(sites_before_);
  restart_at_vertices(control);
  refine_cells(cells, control);
  const Task task = whole_task(goal, placement, level, control);
  IntersectionTracker meeting(embedded_.value_or(WrittenPositions()));
  work_towards(task, meeting, level, control);
  level.at_limit.clear();
  finish(task, goal, meeting, level, control);
  return true;
}

// With all vertices and edges free to change, and cells that can be as small as their vertices.
void Refiner::restart_at_vertices(const RunControl& control) {
  work_->clear_fixed();
  if (work_->placement().anchor != partition().site) divide_surface({}, control);
}

// Topology, and that triangles do not intersect, may need more vertices than are left. Then the last ones are removed, until there is room.
// @return false if no level with more vertices than the one before has few enough
bool Refiner::refine_within_budget(Task& task, double most, IntersectionTracker& meeting, RefinedLevel& out, const RunControl& control) {
  const std::uint32_t start = partition().cell_count();
  work_towards(task, meeting, out, control);
  double kept = most;
  for (double times = 1; partition().cell_count() > most; times *= 2) {
    kept = std::floor(kept - times * (partition().cell_count() - most));
    const bool has_room = kept > start;
    remove_sites(has_room ? static_cast<std::uint32_t>(kept) : start, control);
    if (!has_room && !is_first_) return false;
    task.most_sites = partition().cell_count();
    out.vertices_ran_out = true;
    work_->update(out.certificate, control);
    if (embedded_) separate_intersections(meeting, out, control);
    if (!has_room) break;
  }
  return true;
}

void Refiner::remove_sites(std::uint32_t count, const RunControl& control) {
  work_->remove_sites(count, control);
  inserted_in_.resize(std::min<std::size_t>(inserted_in_.size(), count));
}

// The level's triangles: shape, and no self-intersections; then what can be said of them.
void Refiner::finish(const Task& task, const LevelGoal& asked, IntersectionTracker& meeting, RefinedLevel& out, const RunControl& control) {
  work_->certify(out.certificate, control);
  std::vector<DualTriangle> triangles;
  improve_level_shape(task, triangles, out, control);
  retry_bad_triangles(task, meeting, triangles, out, control);
  control.report("refine", kShapeShare);
  repair_worst_cells(task, triangles, out, control);
  if (embedded_) revert_intersecting_changes(task, meeting, triangles, out, control);
  if (is_provable(task) && work_->is_within_bounds()) {
    if (task.placement == Placement::balanced) work_->clear_proofs();  // vertices are moved without a look at all triangles around them
    work_->prove();
  }
  out.figures.distance_at_most = is_provable(task) && work_->is_proved() ? work_->distance_bound() : std::nullopt;
  work_->fix_anchors(partition().cell_count());
  out.triangles = to_triangles(triangles);
  report_going_on(control);
  describe(task, asked, out);
}

void Refiner::improve_level_shape(const Task& task, std::vector<DualTriangle>& triangles, RefinedLevel& out, const RunControl& control) {
  const std::size_t moves = out.shape.moves, shifts = out.shape.displacements;  // these stay, flips do not
  out.shape = improve_shape(*work_, *task.shape, triangles, control);
  out.shape.moves += moves;
  out.shape.displacements += shifts;
}

void Refiner::refine_and_improve(const Task& task, IntersectionTracker& meeting, std::vector<DualTriangle>& triangles, RefinedLevel& out,
                                 const RunControl& control) {
  work_towards(task, meeting, out, control);
  work_->certify(out.certificate, control);
  improve_level_shape(task, triangles, out, control);
}

// Where neither a flip nor a move mends a triangle, smaller cells around it give another mesh, and another chance.
void Refiner::retry_bad_triangles(const Task& task, IntersectionTracker& meeting, std::vector<DualTriangle>& triangles, RefinedLevel& out,
                                  const RunControl& control) {
  std::size_t fewest = out.shape.bad;
  int in_vain = 0;
  for (int chance = 0; chance < kMostChances && in_vain < kMostInVain && out.shape.bad > 0 && out.shape.bad < kFewTriangles; ++chance) {
    if (task.most_sites != kNone || !make_smaller_at_bad_triangles(*work_, task, triangles)) break;
    refine_and_improve(task, meeting, triangles, out, control);
    const bool helps = static_cast<double>(out.shape.bad) <= (1 - kWorthAChance) * static_cast<double>(fewest);
    in_vain = helps ? 0 : in_vain + 1;
    fewest = std::min(fewest, out.shape.bad);
  }
}

// What nothing else can help: of the cells at their limit, the worst.
void Refiner::repair_worst_cells(const Task& task, std::vector<DualTriangle>& triangles, RefinedLevel& out, const RunControl& control) {
  std::vector<std::pair<double, CellId>> worst = cells_at_limit(task);
  if (worst.size() > kMostMended) worst.resize(kMostMended);
  std::vector<CellId> to_mend;
  for (const auto& [excess, c] : worst) to_mend.push_back(c);
  improve_errors(*work_, *task.shape, to_mend, triangles, out.shape, control);
}

void Refiner::revert_intersecting_changes(const Task& task, IntersectionTracker& meeting, std::vector<DualTriangle>& triangles,
                                          RefinedLevel& out, const RunControl& control) {
  for (int k = 0; !revert_intersecting(*work_, meeting, triangles, control).empty(); ++k) {
    if (k == kMostChances) {  // the dual as it is does not meet itself
      revert_all(*work_, triangles, control);
      break;
    }
    refine_and_improve(task, meeting, triangles, out, control);
    repair_worst_cells(task, triangles, out, control);
  }
  improve_shape_without_intersections(*work_, *task.shape, meeting, triangles, out.shape, control);
  // What balancing did since is not undone with a change that is taken back; nor need c-vertices do without others what they do with
  // them.
  do {
    if (!revert_intersecting(*work_, meeting, triangles, control).empty()) {
      revert_all(*work_, triangles, control);
      work_apart({}, meeting, out, control);
      work_->certify(out.certificate, control);
      triangles.assign(work_->triangles().begin(), work_->triangles().end());
    }
  } while (revert_conflicting_moves(*work_, triangles, control));
}

// What the level reached, by what was asked for.
void Refiner::describe(const Task& task, const LevelGoal& asked, RefinedLevel& out) {
  const std::vector<MetricValues> values = work_->measure_metrics();
  Obstacles obstacles{&extent_, is_first_, out.vertices_ran_out, false, 0};
  for (const auto& [c, excess] : cells_over(asked, values)) {
    const float radius = work_->covering().radius()[partition().site[c]];
    if (is_at_limit(task, c)) {
      out.at_limit.emplace_back(c, excess);
    } else if (radius <= kChordSlack * task.shortest_edge * 1.0001f) {
      obstacles.edges_in_the_way = true;
    }
  }
  obstacles.cells_at_limit = out.at_limit.size();
  out.figures.metrics = summarize(values);
  out.figures.distance = distances(values);
  surface_data_->check_cancelled();
  MeshExtent extent = extent_of(work_->mesh());
  out.figures.constraints = judge(asked, extent, out.figures.metrics, obstacles);
  extent_ = std::move(extent);
  metrics_ = out.figures.metrics;
}

LevelFigures Refiner::describe_coarse(std::span<const Triangle> triangles, const LevelGoal& goal, const RunControl& control) {
  control.check_cancelled();
  Covering covering(surface_data_->graph, options_);
  covering.seed(start_.placement.anchor, {}, control);
  std::vector<DualTriangle> dual;
  dual.reserve(triangles.size());
  for (const Triangle& t : triangles) dual.push_back({t, kNone});
  control.check_cancelled();
  const LevelMesh mesh = make_level_mesh(surface_data_->surfels, covering.partition(), dual, start_.placement, &control);
  control.check_cancelled();
  extent_ = extent_of(mesh);
  const std::vector<MetricValues> values = measure_metrics(*surface_data_, covering, mesh);
  metrics_ = summarize(values);
  return {metrics_, judge(goal, extent_, metrics_, {}), distances(values), {}};
}

std::vector<std::uint32_t> Refiner::parents() const {
  std::vector<std::uint32_t> out(work_->covering().inserted_in());
  for (std::uint32_t c = 0; c < out.size(); ++c) {
    if (c < inserted_in_.size() && inserted_in_[c] != kNone) out[c] = inserted_in_[c];
    if (c < sites_before_ || out[c] == kNone) {
      out[c] = c;
    } else {
      while (out[c] >= sites_before_) out[c] = out[out[c]];  // placed in the cell of a vertex that is new as well
    }
  }
  return out;
}

}  // namespace isoatlas::detail
