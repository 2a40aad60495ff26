// SPDX-License-Identifier: Apache-2.0
#include "error/measured_covering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/parallel.h"
#include "core/vector_math.h"
#include "error/balance.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kCellsPerPiece = 64;

CellView view_of(const Ground& ground, const Covering& covering, const LevelMesh& mesh, CellId cell, std::span<const ClosestPoint> closest,
                 float from_mesh) {
  return {ground.surfels,
          ground.graph,
          covering.distance(),
          covering.partition().cell_of,
          mesh.normal,
          mesh.triangles,
          mesh.triangle_normal,
          covering.partition().site[cell],
          mesh.c_vertices_of.row(cell),
          closest,
          from_mesh};
}

}  // namespace

Constraint scaled(Constraint c, double by) {
  c.bound = is_metric(c.quantity) && unit(c.quantity) == Unit::ratio ? 1 + by * (c.bound - 1) : by * c.bound;
  return c;
}

// Of a ratio what counts is its distance from 1, which like distances goes with the square of the cell's size.
double excess_of(Quantity quantity, double value, double bound) {
  return unit(quantity) == Unit::ratio ? (value - 1) / (bound - 1) : value / bound;
}

double longest_edge(const LevelMesh& mesh, CellId cell) {
  double squared = 0;
  for (const std::uint32_t t : mesh.triangles_of.row(cell)) {
    for (const CellId other : mesh.triangles[t]) squared = std::max(squared, squared_length(mesh.point[cell] - mesh.point[other]));
  }
  return std::sqrt(squared);
}

Ground::Ground(const SurfaceComplex& surface, const Isosurface* trilinear, const AdaptiveSurface* who_may_roam, const RunControl* who_stops)
    : complex(surface),
      isosurface(trilinear),
      roaming(who_may_roam),
      control(who_stops == nullptr && roaming != nullptr ? &roaming->control() : who_stops) {
  graph.first.assign(1, 0);
  remake();
}

std::vector<std::uint8_t> Ground::remake() {
  moved_from = {};  // what is made anew is freed first, but for the graph: two of each would be the peak of memory
  between.reset();
  grid_cells.reset();
  std::vector<std::uint8_t> changed = remake_graph(graph, complex, control);
  for (CVertexId v = 0; v < std::min(surfels.point.size(), changed.size()); ++v) {
    if (!(surfels.point[v] == scaled(complex.positions[v], complex.spacing))) changed[v] = 1;
  }
  surfels = {};
  surfels = make_surfels(complex, control);
  reach.assign(graph.c_vertex_count(), 0);
  for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
    for (const CVertexGraph::Neighbour& n : graph.row(v)) reach[v] = std::max(reach[v], n.weight);
  }
  if (roaming != nullptr && !std::ranges::equal(roaming->original_positions(), complex.positions)) {
    moved_from.reserve(complex.positions.size());
    for (const Vec3& p : roaming->original_positions()) moved_from.push_back(scaled(p, complex.spacing));
  }
  check_cancelled();
  if (isosurface != nullptr) between.emplace(complex, *isosurface);
  check_cancelled();
  return changed;
}

MeasuredCovering::MeasuredCovering(const Ground& ground, const CoveringOptions& options, std::span<const CVertexId> sites,
                                   std::span<const Covering::Radius> radii, const RunControl& control)
    : ground_(ground), covering_(ground.graph, options), dual_(ground.complex, covering_) {
  covering_.seed(sites, radii, control);
  covering_.ignore_events();
  covering_.cover(control);
}

std::vector<Vec3> MeasuredCovering::base_points() const {
  std::vector<Vec3> out;
  out.reserve(places_.anchor.size());
  for (CellId c = 0; c < places_.anchor.size(); ++c) out.push_back(places_.base(ground_.surfels, c));
  return out;
}

void MeasuredCovering::continue_on(std::span<const std::uint8_t> changed, std::span<const Vec3> before, const RunControl& control) {
  places_.shift.clear();
  std::vector<CVertexId> back;  // c-vertices of vertices that went back to where they were before they were moved
  const Vec3 s = ground_.complex.spacing;
  const double rounding = 1e-6 * std::min({s.x, s.y, s.z});
  for (CellId c = 0; c < places_.anchor.size(); ++c) {
    if (length(ground_.surfels.point[places_.anchor[c]] - before[c]) > rounding) back.push_back(places_.anchor[c]);
  }
  if (!mesh_.point.empty()) {
    std::vector<CellId> all(places_.anchor.size());
    std::iota(all.begin(), all.end(), 0u);
    place(mesh_, ground_.surfels, all, places_, &control);
    control.check_cancelled();
  }
  covering_.adapt_to(changed, places_.anchor, control);
  covering_.ignore_events();
  control.check_cancelled();
  dual_.adapt_to(changed);
  control.check_cancelled();
  dual_.mark_touched_near(back, control);
  control.check_cancelled();
  covering_.cover(control);
}

MeasuredCovering::MeasuredCovering(const MeasuredCovering& other)
    : ground_(other.ground_),
      covering_(other.covering_),
      dual_(other.dual_, covering_),
      demands_(other.demands_),
      placement_(other.placement_),
      near_enough_(other.near_enough_),
      mesh_(other.mesh_),
      places_(other.places_),
      frozen_(other.frozen_),
      proved_(other.proved_),
      from_mesh_(other.from_mesh_),
      sampled_triangles_(other.sampled_triangles_),
      proved_triangles_(other.proved_triangles_),
      errors_(other.errors_),
      stands_alone_(other.stands_alone_),
      moved_(other.moved_),
      all_moved_(other.all_moved_),
      stale_(other.stale_),
      all_stale_(other.all_stale_) {}

void MeasuredCovering::remove_sites(std::uint32_t count, const RunControl& control) {
  covering_.remove_sites(count, control);
  dual_.remove_cells(count);
  const auto shorten = [&](auto& of_cell) { of_cell.resize(std::min<std::size_t>(of_cell.size(), count)); };
  shorten(places_.anchor);
  shorten(places_.offset);
  shorten(places_.shift);
  shorten(places_.given_up);
  shorten(errors_);
  shorten(stale_);
  std::erase_if(moved_, [&](CellId c) { return c >= count; });
}

void MeasuredCovering::demand(std::span<const Constraint> metrics, Placement placement, double near_enough) {
  if (std::ranges::equal(metrics, demands_) && placement == placement_ && near_enough == near_enough_) return;
  near_enough_ = near_enough;
  demands_.assign(metrics.begin(), metrics.end());
  if (placement == Placement::surface) places_.offset.clear();
  all_moved_ = true;
  placement_ = placement;
  all_stale_ = true;
}

void MeasuredCovering::tighten(double share) {
  forget_proofs();
  for (Constraint& c : demands_) c = scaled(c, share);
  stale_.resize(errors_.size(), 0);
  for (CellId c = 0; c < errors_.size(); ++c) {
    CellError& error = errors_[c];
    if (error.excess <= 1 && error.at_most > share) stale_[c] = 1;
    error.excess /= share;
    error.at_most /= share;
  }
}

void MeasuredCovering::update(CertificateReport& report, const RunControl& control) {
  covering_.cover(control);
  dual_.update(report, control);
  for (CellId c = static_cast<CellId>(places_.anchor.size()); c < partition().cell_count(); ++c)
    places_.anchor.push_back(partition().site[c]);
  if (!places_.shift.empty()) places_.shift.resize(partition().cell_count());
  keep_apart();
  if (!places_.offset.empty()) places_.offset.resize(partition().cell_count(), 0);
  control.check_cancelled();
  std::vector<std::uint8_t> renewed;  // per cell, 1 if its triangles are not what they were
  if (mesh_.point.empty()) {
    mesh_ = make_level_mesh(ground_.surfels, partition(), dual_.triangles(), places_, &control);
    renewed.assign(partition().cell_count(), 1);
  } else {
    std::vector<CellId> touched;  // among them all new ones
    for (CellId c = 0; c < partition().cell_count(); ++c) {
      if (dual_.touched()[c]) touched.push_back(c);
    }
    set_cells(mesh_, covering_.members(), touched);
    moved_.insert(moved_.end(), touched.begin(), touched.end());
    control.check_cancelled();
    renewed = all_moved_ ? set_triangles(mesh_, ground_.surfels, dual_.triangles(), places_, &control)
                         : set_triangles(mesh_, ground_.surfels, dual_.triangles(), places_, moved_, &control);
  }
  moved_.clear();
  all_moved_ = false;
  control.check_cancelled();
  measure(cells_to_measure(renewed), Thoroughness::quick);
}

// A cell's metrics look at its c-vertices and triangles, and, unless it stands alone, at the triangles around its neighbours.
std::vector<CellId> MeasuredCovering::cells_to_measure(std::span<const std::uint8_t> renewed) {
  std::vector<CellId> cells;
  if (std::exchange(all_stale_, false)) {
    cells.resize(partition().cell_count());
    std::iota(cells.begin(), cells.end(), 0u);
  } else {
    stale_.resize(partition().cell_count(), 0);
    for (CellId c = 0; c < stale_.size(); ++c) stale_[c] |= static_cast<std::uint8_t>(dual_.touched()[c] | renewed[c]);
    const auto stands_alone = [&](CellId c) { return c < stands_alone_.size() && stands_alone_[c] && errors_[c].excess <= 1; };
    for (CellId near = 0; near < renewed.size(); ++near) {
      if (!renewed[near]) continue;
      for (const std::uint32_t t : mesh_.triangles_of.row(near)) {
        for (const CellId c : mesh_.triangles[t]) stale_[c] |= static_cast<std::uint8_t>(!stands_alone(c));
      }
    }
    for (CellId c = 0; c < stale_.size(); ++c) {
      if (stale_[c]) cells.push_back(c);
    }
  }
  dual_.clear_touched();
  stale_.clear();
  return cells;
}

// Where a vertex was moved to may be in another cell by now, or a site itself: no two vertices may be at one c-vertex.
void MeasuredCovering::keep_apart() {
  std::vector<CVertexId>& anchor = places_.anchor;
  const std::vector<CellId>& cell_of = partition().cell_of;
  std::vector<CellId> conflicting_moves;  // frozen, so it is the other one that gives way
  for (CellId c = 0; c < anchor.size(); ++c) {
    if (cell_of[anchor[c]] == c) continue;
    if (is_frozen(c)) {
      conflicting_moves.push_back(c);
    } else {
      move_to(c, partition().site[c]);
    }
  }
  if (conflicting_moves.empty()) return;
  std::vector<std::uint8_t> taken(cell_of.size(), 0);
  for (const CVertexId v : anchor) ++taken[v];
  for (const CellId c : conflicting_moves) {
    const CellId owner = cell_of[anchor[c]];
    if (anchor[owner] != anchor[c]) continue;
    move_to(owner, free_place_near(anchor[c], owner, taken));
    --taken[anchor[c]];
    ++taken[anchor[owner]];
  }
}

void MeasuredCovering::move_to(CellId cell, CVertexId c_vertex) {
  moved_.push_back(cell);
  places_.anchor[cell] = c_vertex;
  if (!places_.shift.empty()) places_.shift[cell] = {};
}

// The c-vertex fewest steps away that is not taken, of the cell if it has one. There are no fewer c-vertices than vertices.
CVertexId MeasuredCovering::free_place_near(CVertexId start, CellId cell, const std::vector<std::uint8_t>& taken) const {
  std::vector<CVertexId> reached{start};
  std::vector<std::uint8_t> seen(taken.size(), 0);
  seen[start] = 1;
  CVertexId elsewhere = kNone;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    for (const CVertexGraph::Neighbour& n : ground_.graph.row(reached[i])) {
      if (std::exchange(seen[n.id], 1)) continue;
      const bool own = partition().cell_of[n.id] == cell;
      if (own && !taken[n.id]) return n.id;
      if (elsewhere == kNone && !taken[n.id]) elsewhere = n.id;
      if (own || elsewhere == kNone) reached.push_back(n.id);
    }
  }
  return elsewhere;
}

void MeasuredCovering::update_all(CertificateReport& report, const RunControl& control) {
  all_stale_ = true;
  update(report, control);
}

void MeasuredCovering::remesh(std::span<const DualTriangle> triangles, const MeshEdit& edit, std::span<const CellId> concerned) {
  for (const CellId c : edit.vertices) {
    if (c < places_.offset.size() && !places_.may_move(c)) places_.offset[c] = 0;
  }
  stale_.resize(partition().cell_count(), 0);
  for (const CellId c : concerned) stale_[c] = 1;  // the next update() takes the dual's triangles again
  ground_.check_cancelled();
  edit_mesh(mesh_, ground_.surfels, triangles, places_, edit, ground_.control);
  measure({concerned.begin(), concerned.end()}, Thoroughness::exact);  // to be compared
}

void MeasuredCovering::measure(std::vector<CellId> cells, Thoroughness thoroughness) {
  const MeasuredSurface surface = ground_.measured();
  errors_.resize(partition().cell_count());
  proved_.resize(partition().cell_count(), 0);
  stands_alone_.resize(partition().cell_count(), 0);
  for (const CellId c : cells) proved_[c] = 0;
  if (placement_ == Placement::balanced) balance(surface, cells, mesh_, places_);
  const std::optional<double> bound = distance_bound();
  const bool need_own_only = placement_ == Placement::surface && std::ranges::all_of(demands_, [](const Constraint& c) {
                               return c.quantity == Quantity::max_distance || c.quantity == Quantity::max_edge;
                             });
  const bool need_closest = std::any_of(demands_.begin(), demands_.end(), [](const Constraint& c) {
    return c.quantity != Quantity::max_distance && needs_closest(c.quantity);
  });
  std::vector<ClosestPoint> found;
  std::vector<CellDistance> farthest;
  if (need_closest) {
    find_closest(surface, mesh_, cells, found);
  } else if (bound) {
    farthest = find_farthest(surface, mesh_, cells, *bound, thoroughness, ground_.between ? &*ground_.between : nullptr);
  }

  std::vector<std::size_t> first(cells.size() + 1, 0);
  for (std::size_t i = 0; i < cells.size(); ++i) first[i + 1] = first[i] + mesh_.c_vertices_of.row(cells[i]).size();
  for_each_piece(cells.size(), kCellsPerPiece, [&](std::size_t begin, std::size_t end) {
    surface.check_cancelled();
    for (std::size_t i = begin; i < end; ++i) {
      const CellId c = cells[i];
      const std::span<const ClosestPoint> closest =
          need_closest ? std::span<const ClosestPoint>(found).subspan(first[i], first[i + 1] - first[i]) : std::span<const ClosestPoint>();
      const CellView cell = view_of(ground_, covering_, mesh_, c, closest, 0);
      CellError& error = errors_[c] = {};
      for (const Constraint& d : demands_) {
        const double value = d.quantity == Quantity::max_edge                        ? longest_edge(mesh_, c)
                             : d.quantity == Quantity::max_distance && !need_closest ? static_cast<double>(farthest[i].farthest.distance)
                                                                                     : evaluate(d.quantity, cell);
        error.excess = std::max(error.excess, excess_of(d.quantity, value, d.bound));
      }
      Farthest most = farthest.empty() ? Farthest{} : farthest[i].farthest;
      for (std::size_t k = 0; k < closest.size(); ++k) {
        if (closest[k].distance > most.distance) most = {closest[k].distance, cell.c_vertices[k]};
      }
      error.worst = most.at;
      stands_alone_[c] = need_own_only && (farthest.empty() || farthest[i].is_from_own);
    }
  });

  // What is between c-vertices, and the way from the mesh to the surface, which costs most, are only looked at where all else is
  // within its bounds.
  for (const CellId c : cells) errors_[c].at_most = errors_[c].excess;
  if (!bound) return;
  const auto keep_good = [&] { std::erase_if(cells, [&](CellId c) { return errors_[c].excess > 1; }); };
  keep_good();
  if (need_closest) {  // find_farthest() has looked between them
    measure_between_c_vertices(cells, *bound);
    keep_good();
  }
  measure_from_triangles(cells, *bound);
  for (const CellId c : cells) errors_[c].at_most = std::max(errors_[c].at_most, near_enough_);
}

std::size_t MeasuredCovering::prove() {
  const std::optional<double> bound = distance_bound();
  if (!bound || ground_.isosurface == nullptr) return 0;
  std::vector<CellId> cells;
  const auto keep_good = [&] { std::erase_if(cells, [&](CellId c) { return errors_[c].excess > 1; }); };
  for (CellId c = 0; c < errors_.size(); ++c) {
    if (!proved_[c]) cells.push_back(c);
  }
  keep_good();
  const std::size_t good = cells.size();
  measure_from_triangles(cells, *bound, Look::proof);
  keep_good();
  prove_surface(cells, *bound);
  keep_good();
  return good - cells.size();
}

bool MeasuredCovering::is_proved() const {
  return !errors_.empty() && std::ranges::all_of(proved_, [](std::uint8_t proved) { return proved != 0; });
}

bool MeasuredCovering::is_within_bounds() const {
  return std::ranges::all_of(errors_, [](const CellError& e) { return e.excess <= 1; });
}

std::optional<double> MeasuredCovering::distance_bound() const {
  const auto found = std::ranges::find(demands_, Quantity::max_distance, &Constraint::quantity);
  return found == demands_.end() ? std::nullopt : std::optional(found->bound);
}

void MeasuredCovering::prove_surface(std::span<const CellId> cells, double bound) {
  if (cells.empty()) return;
  if (!ground_.grid_cells) ground_.grid_cells.emplace(ground_.complex, ground_.isosurface->field().last(), ground_.control);
  const std::vector<Farthest> left = prove_surface_near(ground_.measured(), *ground_.grid_cells, mesh_, partition().cell_of, cells, bound);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    proved_[cells[i]] = left[i].at == kNone;
    if (left[i].at != kNone) add_distance(cells[i], left[i], bound);
  }
}

void MeasuredCovering::measure_fully(std::span<const CellId> cells) {
  const std::optional<double> bound = distance_bound();
  if (!bound) return;
  measure_between_c_vertices(cells, *bound);
  measure_from_triangles(cells, *bound);
}

void MeasuredCovering::measure_between_c_vertices(std::span<const CellId> cells, double bound) {
  if (!ground_.between) return;
  const std::vector<Farthest> between = measure_between(ground_.measured(), *ground_.between, mesh_, cells, bound);
  for (std::size_t i = 0; i < cells.size(); ++i) add_distance(cells[i], between[i], bound);
}

void MeasuredCovering::measure_from_triangles(std::span<const CellId> cells, double bound, Look look) {
  if (ground_.isosurface == nullptr) return;
  from_mesh_.resize(partition().cell_count());
  for (const CellId c : cells) from_mesh_[c] = {};
  TriangleErrors* const known = look == Look::proof ? proved_triangles_.get() : sampled_triangles_.get();
  measure_from_mesh(ground_.measured(), mesh_, partition().cell_of, cells, near_enough_ * bound, look, from_mesh_, known);
  for (const CellId c : cells) add_distance(c, from_mesh_[c], bound);
}

void MeasuredCovering::add_distance(CellId cell, const Farthest& most, double bound) {
  const double excess = static_cast<double>(most.distance) / bound;
  if (excess > errors_[cell].excess) errors_[cell] = {excess, excess, most.at};
}

std::vector<MetricValues> measure_metrics(const Ground& ground, const Covering& covering, const LevelMesh& mesh, TriangleErrors* known,
                                          bool is_proved) {
  const std::uint32_t n = mesh.cell_count();
  std::vector<CellId> cells(n);
  std::iota(cells.begin(), cells.end(), 0u);
  std::vector<ClosestPoint> closest;
  std::vector<Farthest> farthest;
  find_closest(ground.measured(), mesh, cells, closest);
  ground.report_going_on();
  std::vector<std::size_t> first(n + 1, 0);
  for (CellId c = 0; c < n; ++c) first[c + 1] = first[c] + mesh.c_vertices_of.row(c).size();
  // Of each cell only the largest distance counts: from its c-vertices, from the points between them, from its triangles.
  farthest.resize(n);
  float most = 0;
  for (CellId c = 0; c < n; ++c) {
    const auto c_vertices = mesh.c_vertices_of.row(c);
    for (std::size_t k = 0; k < c_vertices.size(); ++k) {
      const float distance = closest[first[c] + k].distance;
      if (distance > farthest[c].distance) farthest[c] = {distance, c_vertices[k]};
    }
    most = std::max(most, farthest[c].distance);
  }
  if (ground.between) farthest = measure_between(ground.measured(), *ground.between, mesh, cells, 0, std::move(farthest));
  if (ground.isosurface != nullptr && !is_proved)
    measure_from_mesh(ground.measured(), mesh, covering.partition().cell_of, cells, static_cast<double>(most), Look::samples, farthest,
                      known);
  ground.report_going_on();
  std::vector<MetricValues> values(n);
  for_each_piece_going_on(n, kCellsPerPiece, ground.control, [&](std::size_t begin, std::size_t end) {
    ground.check_cancelled();
    for (std::size_t i = begin; i < end; ++i) {
      const auto c = static_cast<CellId>(i);
      const std::span<const ClosestPoint> own = std::span<const ClosestPoint>(closest).subspan(first[c], first[c + 1] - first[c]);
      const CellView cell = view_of(ground, covering, mesh, c, own, farthest[c].distance);
      for (std::size_t m = 0; m < kMetricCount; ++m) values[c][m] = evaluate(static_cast<Quantity>(m), cell);
    }
  });
  return values;
}

std::vector<MetricValues> MeasuredCovering::measure_metrics() const {
  return isoatlas::detail::measure_metrics(ground_, covering_, mesh_, sampled_triangles_.get(), is_proved());
}

std::array<MetricSummary, kMetricCount> summarize(std::span<const MetricValues> values) {
  std::array<MetricSummary, kMetricCount> out{};
  for (const MetricValues& value : values) {
    for (std::size_t m = 0; m < kMetricCount; ++m) {
      out[m].maximum = std::max(out[m].maximum, value[m]);
      out[m].mean += value[m] / static_cast<double>(values.size());
    }
  }
  return out;
}

}  // namespace isoatlas::detail
