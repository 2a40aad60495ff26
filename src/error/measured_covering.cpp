// SPDX-License-Identifier: Apache-2.0
#include "error/measured_covering.h"
#include "error/custom_metric.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/parallel.h"
#include "core/ranges.h"
#include "core/vector_math.h"
#include "error/balance.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kCoveredCellsPerChunk = 64;

CellView view_of(const SurfaceData& surface_data, const Covering& covering, const LevelMesh& mesh,
                 CellId cell, std::span<const ClosestPoint> closest, float from_mesh) {
  return {surface_data.surfels,
          surface_data.graph,
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

Constraint scaled(Constraint c, double factor) {
  c.bound = is_metric(c.quantity) && unit(c.quantity) == Unit::ratio ? 1 + factor * (c.bound - 1)
                                                                     : factor * c.bound;
  return c;
}

// For a ratio its difference from 1 counts. Like a distance, this is proportional to the square of
// the cell's size.
double excess_of(Quantity quantity, double value, double bound) {
  return unit(quantity) == Unit::ratio ? (value - 1) / (bound - 1) : value / bound;
}

double longest_edge(const LevelMesh& mesh, CellId cell) {
  double squared = 0;
  for (const std::uint32_t t : mesh.triangles_of.row(cell)) {
    for (const CellId other : mesh.triangles[t])
      squared = std::max(squared, squared_length(mesh.point[cell] - mesh.point[other]));
  }
  return std::sqrt(squared);
}

SurfaceData::SurfaceData(const SurfaceComplex& surface, const Isosurface* trilinear,
                         const AdaptiveSurface* adaptive, const RunControl* run_control)
    : complex(surface),
      isosurface(trilinear),
      adaptive_surface(adaptive),
      control(run_control == nullptr && adaptive != nullptr ? &adaptive->control() : run_control) {
  graph.first.assign(1, 0);
  rebuild();
}

std::vector<std::uint8_t> SurfaceData::rebuild() {
  original_points = {};  // frees old data first, except the graph; keeping both would determine the
                         // peak of memory
  face_nodes.reset();
  grid_cell_index.reset();
  std::vector<std::uint8_t> changed = rebuild_graph(graph, complex, control);
  for (CVertexId v = 0; v < std::min(surfels.point.size(), changed.size()); ++v) {
    if (!(surfels.point[v] == to_metric(complex.positions[v], complex.spacing))) changed[v] = 1;
  }
  surfels = {};
  surfels = make_surfels(complex, control);
  farthest_neighbour.assign(graph.c_vertex_count(), 0);
  for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
    for (const CVertexGraph::Neighbour& n : graph.row(v))
      farthest_neighbour[v] = std::max(farthest_neighbour[v], length_of(n));
  }
  if (adaptive_surface != nullptr &&
      !ranges::equal(adaptive_surface->original_positions(), complex.positions)) {
    original_points.reserve(complex.positions.size());
    for (const Vec3& p : adaptive_surface->original_positions())
      original_points.push_back(to_metric(p, complex.spacing));
  }
  check_cancelled();
  if (isosurface != nullptr) face_nodes.emplace(complex, *isosurface);
  check_cancelled();
  return changed;
}

MeasuredCovering::MeasuredCovering(const SurfaceData& surface_data, const CoveringOptions& options,
                                   std::span<const CVertexId> sites,
                                   std::span<const Covering::Radius> radii,
                                   const RunControl& control)
    : surface_data_(surface_data),
      covering_(surface_data.graph, options),
      dual_(surface_data.complex, covering_) {
  covering_.seed(sites, radii, control);
  covering_.ignore_events();
  covering_.cover(control);
}

std::vector<Vec3> MeasuredCovering::base_points() const {
  std::vector<Vec3> out;
  out.reserve(vertex_placement_.anchor.size());
  for (CellId c = 0; c < vertex_placement_.anchor.size(); ++c)
    out.push_back(vertex_placement_.base_point(surface_data_.surfels, c));
  return out;
}

void MeasuredCovering::adapt_to(std::span<const std::uint8_t> changed, std::span<const Vec3> before,
                                const RunControl& control) {
  vertex_placement_.displacement.clear();
  std::vector<CVertexId>
      moved_back;  // c-vertices of vertices that are back at their positions before the move
  const Vec3 s = surface_data_.complex.spacing;
  const double rounding = 1e-6 * std::min({s.x, s.y, s.z});
  for (CellId c = 0; c < vertex_placement_.anchor.size(); ++c) {
    if (length(surface_data_.surfels.point[vertex_placement_.anchor[c]] - before[c]) > rounding)
      moved_back.push_back(vertex_placement_.anchor[c]);
  }
  if (!mesh_.point.empty()) {
    std::vector<CellId> all(vertex_placement_.anchor.size());
    std::iota(all.begin(), all.end(), 0u);
    update_points(mesh_, surface_data_.surfels, all, vertex_placement_, &control);
    control.check_cancelled();
  }
  covering_.adapt_to(changed, vertex_placement_.anchor, control);
  covering_.ignore_events();
  control.check_cancelled();
  dual_.adapt_to(changed);
  control.check_cancelled();
  dual_.mark_touched_near(moved_back, control);
  control.check_cancelled();
  covering_.cover(control);
}

MeasuredCovering::MeasuredCovering(const MeasuredCovering& other)
    : surface_data_(other.surface_data_),
      covering_(other.covering_),
      dual_(other.dual_, covering_),
      bounds_(other.bounds_),
      placement_mode_(other.placement_mode_),
      exact_above_share_(other.exact_above_share_),
      mesh_(other.mesh_),
      vertex_placement_(other.vertex_placement_),
      fixed_anchor_count_(other.fixed_anchor_count_),
      proved_(other.proved_),
      from_mesh_(other.from_mesh_),
      sampled_errors_(other.sampled_errors_),
      proved_errors_(other.proved_errors_),
      errors_(other.errors_),
      depends_on_own_data_only_(other.depends_on_own_data_only_),
      moved_(other.moved_),
      all_moved_(other.all_moved_),
      stale_(other.stale_),
      all_stale_(other.all_stale_) {}

void MeasuredCovering::remove_sites(std::uint32_t count, const RunControl& control) {
  covering_.remove_sites(count, control);
  dual_.remove_cells(count);
  const auto shorten = [&](auto& of_cell) {
    of_cell.resize(std::min<std::size_t>(of_cell.size(), count));
  };
  shorten(vertex_placement_.anchor);
  shorten(vertex_placement_.normal_offset);
  shorten(vertex_placement_.displacement);
  shorten(vertex_placement_.fixed);
  shorten(errors_);
  shorten(stale_);
  std::erase_if(moved_, [&](CellId c) { return c >= count; });
}

void MeasuredCovering::set_bounds(std::span<const Constraint> metrics, Placement mode,
                                  double exact_above_share) {
  if (ranges::equal(metrics, bounds_) && mode == placement_mode_ &&
      exact_above_share == exact_above_share_)
    return;
  exact_above_share_ = exact_above_share;
  bounds_.assign(metrics.begin(), metrics.end());
  if (mode == Placement::surface) vertex_placement_.normal_offset.clear();
  all_moved_ = true;
  placement_mode_ = mode;
  all_stale_ = true;
}

void MeasuredCovering::tighten_bounds(double share) {
  clear_proofs();
  for (Constraint& c : bounds_) c = scaled(c, share);
  stale_.resize(errors_.size(), 0);
  for (CellId c = 0; c < errors_.size(); ++c) {
    CellError& error = errors_[c];
    if (error.excess <= 1 && error.upper_bound > share) stale_[c] = 1;
    error.excess /= share;
    error.upper_bound /= share;
  }
}

void MeasuredCovering::update(CertificateReport& report, const RunControl& control) {
  covering_.cover(control);
  dual_.update(report, control);
  for (CellId c = static_cast<CellId>(vertex_placement_.anchor.size());
       c < partition().cell_count(); ++c)
    vertex_placement_.anchor.push_back(partition().site[c]);
  if (!vertex_placement_.displacement.empty())
    vertex_placement_.displacement.resize(partition().cell_count());
  resolve_shared_anchors();
  if (!vertex_placement_.normal_offset.empty())
    vertex_placement_.normal_offset.resize(partition().cell_count(), 0);
  control.check_cancelled();
  std::vector<std::uint8_t> changed_cells;  // per cell, 1 if its triangles have changed
  if (mesh_.point.empty()) {
    mesh_ = make_level_mesh(surface_data_.surfels, partition(), dual_.triangles(),
                            vertex_placement_, &control);
    changed_cells.assign(partition().cell_count(), 1);
  } else {
    std::vector<CellId> touched;  // includes all new cells
    for (CellId c = 0; c < partition().cell_count(); ++c) {
      if (dual_.touched()[c]) touched.push_back(c);
    }
    update_cells(mesh_, covering_.members(), touched);
    moved_.insert(moved_.end(), touched.begin(), touched.end());
    control.check_cancelled();
    changed_cells = all_moved_ ? update_triangles(mesh_, surface_data_.surfels, dual_.triangles(),
                                                  vertex_placement_, &control)
                               : update_triangles(mesh_, surface_data_.surfels, dual_.triangles(),
                                                  vertex_placement_, moved_, &control);
  }
  moved_.clear();
  all_moved_ = false;
  control.check_cancelled();
  measure(cells_to_measure(changed_cells), Thoroughness::quick);
}

// The error of a cell depends on its c-vertices and triangles and, unless it depends on these only,
// on the triangles around its neighbours.
std::vector<CellId> MeasuredCovering::cells_to_measure(
    std::span<const std::uint8_t> changed_cells) {
  std::vector<CellId> cells;
  if (std::exchange(all_stale_, false)) {
    cells.resize(partition().cell_count());
    std::iota(cells.begin(), cells.end(), 0u);
  } else {
    stale_.resize(partition().cell_count(), 0);
    for (CellId c = 0; c < stale_.size(); ++c)
      stale_[c] |= static_cast<std::uint8_t>(dual_.touched()[c] | changed_cells[c]);
    const auto depends_on_own_data_only = [&](CellId c) {
      return c < depends_on_own_data_only_.size() && depends_on_own_data_only_[c] &&
             errors_[c].excess <= 1;
    };
    for (CellId near = 0; near < changed_cells.size(); ++near) {
      if (!changed_cells[near]) continue;
      for (const std::uint32_t t : mesh_.triangles_of.row(near)) {
        for (const CellId c : mesh_.triangles[t])
          stale_[c] |= static_cast<std::uint8_t>(!depends_on_own_data_only(c));
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

// The anchor of a vertex may be in another cell by now, or be the site of one, but no two vertices
// may have the same anchor.
void MeasuredCovering::resolve_shared_anchors() {
  std::vector<CVertexId>& anchor = vertex_placement_.anchor;
  const std::vector<CellId>& cell_of = partition().cell_of;
  std::vector<CellId>
      cells_off_anchor;  // their anchors are fixed, so the other cell's vertex is moved
  for (CellId c = 0; c < anchor.size(); ++c) {
    if (cell_of[anchor[c]] == c) continue;
    if (has_fixed_anchor(c)) {
      cells_off_anchor.push_back(c);
    } else {
      set_anchor(c, partition().site[c]);
    }
  }
  if (cells_off_anchor.empty()) return;
  std::vector<std::uint8_t> taken(cell_of.size(), 0);
  for (const CVertexId v : anchor) ++taken[v];
  for (const CellId c : cells_off_anchor) {
    const CellId owner = cell_of[anchor[c]];
    if (anchor[owner] != anchor[c]) continue;
    set_anchor(owner, free_c_vertex_near(anchor[c], owner, taken));
    --taken[anchor[c]];
    ++taken[anchor[owner]];
  }
}

void MeasuredCovering::set_anchor(CellId cell, CVertexId c_vertex) {
  moved_.push_back(cell);
  vertex_placement_.anchor[cell] = c_vertex;
  if (!vertex_placement_.displacement.empty()) vertex_placement_.displacement[cell] = {};
}

// The nearest c-vertex, in steps, that is not taken; one of the cell if there is one. There are
// never more vertices than c-vertices.
CVertexId MeasuredCovering::free_c_vertex_near(CVertexId start, CellId cell,
                                               const std::vector<std::uint8_t>& taken) const {
  std::vector<CVertexId> reached{start};
  std::vector<std::uint8_t> seen(taken.size(), 0);
  seen[start] = 1;
  CVertexId outside = kNone;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    for (const CVertexGraph::Neighbour& n : surface_data_.graph.row(reached[i])) {
      if (std::exchange(seen[n.id], 1)) continue;
      const bool own = partition().cell_of[n.id] == cell;
      if (own && !taken[n.id]) return n.id;
      if (outside == kNone && !taken[n.id]) outside = n.id;
      if (own || outside == kNone) reached.push_back(n.id);
    }
  }
  return outside;
}

void MeasuredCovering::update_all(CertificateReport& report, const RunControl& control) {
  all_stale_ = true;
  update(report, control);
}

void MeasuredCovering::remesh(std::span<const DualTriangle> triangles, const MeshEdit& edit,
                              std::span<const CellId> affected) {
  for (const CellId c : edit.vertices) {
    if (c < vertex_placement_.normal_offset.size() && !vertex_placement_.is_movable(c))
      vertex_placement_.normal_offset[c] = 0;
  }
  stale_.resize(partition().cell_count(), 0);
  for (const CellId c : affected)
    stale_[c] = 1;  // the next update() uses the dual's triangles again
  surface_data_.check_cancelled();
  apply_edit(mesh_, surface_data_.surfels, triangles, vertex_placement_, edit,
             surface_data_.control);
  measure({affected.begin(), affected.end()},
          Thoroughness::exact);  // exact, because the results are compared
}

void MeasuredCovering::measure(std::vector<CellId> cells, Thoroughness thoroughness) {
  const MeasuredSurface surface = surface_data_.measured_surface();
  errors_.resize(partition().cell_count());
  proved_.resize(partition().cell_count(), 0);
  depends_on_own_data_only_.resize(partition().cell_count(), 0);
  for (const CellId c : cells) proved_[c] = 0;
  if (placement_mode_ == Placement::balanced) balance(surface, cells, mesh_, vertex_placement_);
  const std::optional<double> bound = distance_bound();
  const bool uses_own_data_only =
      placement_mode_ == Placement::surface && ranges::all_of(bounds_, [](const Constraint& c) {
        return c.quantity == Quantity::max_distance || c.quantity == Quantity::max_edge ||
               c.quantity == Quantity::custom;
      });
  const bool need_closest = std::any_of(bounds_.begin(), bounds_.end(), [](const Constraint& c) {
    return c.quantity != Quantity::max_distance && needs_closest(c.quantity);
  });
  std::vector<ClosestPoint> found;
  std::vector<CellDistance> farthest;
  if (need_closest) {
    find_closest(surface, mesh_, cells, found);
  } else if (bound) {
    farthest = find_farthest(surface, mesh_, cells, *bound, thoroughness,
                             surface_data_.face_nodes ? &*surface_data_.face_nodes : nullptr);
  }

  std::vector<std::size_t> first(cells.size() + 1, 0);
  for (std::size_t i = 0; i < cells.size(); ++i)
    first[i + 1] = first[i] + mesh_.c_vertices_of.row(cells[i]).size();
  for_each_chunk(cells.size(), kCoveredCellsPerChunk, [&](std::size_t begin, std::size_t end) {
    surface.check_cancelled();
    for (std::size_t i = begin; i < end; ++i) {
      const CellId c = cells[i];
      const std::span<const ClosestPoint> closest =
          need_closest
              ? std::span<const ClosestPoint>(found).subspan(first[i], first[i + 1] - first[i])
              : std::span<const ClosestPoint>();
      const CellView cell = view_of(surface_data_, covering_, mesh_, c, closest, 0);
      CellError& error = errors_[c] = {};
      for (const Constraint& d : bounds_) {
        const double value = d.quantity == Quantity::max_edge ? longest_edge(mesh_, c)
                             : d.quantity == Quantity::custom
                                 ? custom_value(*d.custom, surface.surfels, mesh_, c)
                             : d.quantity == Quantity::max_distance && !need_closest
                                 ? static_cast<double>(farthest[i].farthest.distance)
                                 : evaluate(d.quantity, cell);
        error.excess = std::max(error.excess, excess_of(d.quantity, value, d.bound));
      }
      Farthest own_farthest = farthest.empty() ? Farthest{} : farthest[i].farthest;
      for (std::size_t k = 0; k < closest.size(); ++k) {
        if (closest[k].distance > own_farthest.distance)
          own_farthest = {closest[k].distance, cell.c_vertices[k]};
      }
      error.worst = own_farthest.at;
      depends_on_own_data_only_[c] =
          uses_own_data_only && (farthest.empty() || farthest[i].is_from_own);
    }
  });

  // Face nodes and the distance from the mesh to the surface cost most. They are only measured for
  // cells that satisfy all other bounds.
  for (const CellId c : cells) errors_[c].upper_bound = errors_[c].excess;
  if (!bound) return;
  const auto keep_within_bounds = [&] {
    std::erase_if(cells, [&](CellId c) { return errors_[c].excess > 1; });
  };
  keep_within_bounds();
  if (need_closest) {  // find_farthest() has already measured them
    measure_face_nodes_of(cells, *bound);
    keep_within_bounds();
  }
  measure_from_triangles(cells, *bound);
  for (const CellId c : cells)
    errors_[c].upper_bound = std::max(errors_[c].upper_bound, exact_above_share_);
}

std::size_t MeasuredCovering::prove() {
  const std::optional<double> bound = distance_bound();
  if (!bound || surface_data_.isosurface == nullptr) return 0;
  std::vector<CellId> cells;
  const auto keep_within_bounds = [&] {
    std::erase_if(cells, [&](CellId c) { return errors_[c].excess > 1; });
  };
  for (CellId c = 0; c < errors_.size(); ++c) {
    if (!proved_[c]) cells.push_back(c);
  }
  keep_within_bounds();
  const std::size_t count_before = cells.size();
  measure_from_triangles(cells, *bound, Evidence::proof);
  keep_within_bounds();
  prove_surface(cells, *bound);
  keep_within_bounds();
  return count_before - cells.size();
}

bool MeasuredCovering::is_proved() const {
  return !errors_.empty() &&
         ranges::all_of(proved_, [](std::uint8_t proved) { return proved != 0; });
}

bool MeasuredCovering::is_within_bounds() const {
  return ranges::all_of(errors_, [](const CellError& e) { return e.excess <= 1; });
}

std::optional<double> MeasuredCovering::distance_bound() const {
  const auto found = ranges::find(bounds_, Quantity::max_distance, &Constraint::quantity);
  return found == bounds_.end() ? std::nullopt : std::optional(found->bound);
}

void MeasuredCovering::prove_surface(std::span<const CellId> cells, double bound) {
  if (cells.empty()) return;
  if (!surface_data_.grid_cell_index)
    surface_data_.grid_cell_index.emplace(
        surface_data_.complex, surface_data_.isosurface->field().last(), surface_data_.control);
  const std::vector<Farthest> left =
      prove_surface_near(surface_data_.measured_surface(), *surface_data_.grid_cell_index, mesh_,
                         partition().cell_of, cells, bound);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    proved_[cells[i]] = left[i].at == kNone;
    if (left[i].at != kNone) add_error(cells[i], left[i], bound);
  }
}

void MeasuredCovering::complete_errors(std::span<const CellId> cells) {
  const std::optional<double> bound = distance_bound();
  if (!bound) return;
  measure_face_nodes_of(cells, *bound);
  measure_from_triangles(cells, *bound);
}

void MeasuredCovering::measure_face_nodes_of(std::span<const CellId> cells, double bound) {
  if (!surface_data_.face_nodes) return;
  const std::vector<Farthest> farthest = measure_face_nodes(
      surface_data_.measured_surface(), *surface_data_.face_nodes, mesh_, cells, bound);
  for (std::size_t i = 0; i < cells.size(); ++i) add_error(cells[i], farthest[i], bound);
}

void MeasuredCovering::measure_from_triangles(std::span<const CellId> cells, double bound,
                                              Evidence evidence) {
  if (surface_data_.isosurface == nullptr) return;
  from_mesh_.resize(partition().cell_count());
  for (const CellId c : cells) from_mesh_[c] = {};
  TriangleErrorCache* const cache =
      evidence == Evidence::proof ? proved_errors_.get() : sampled_errors_.get();
  measure_from_mesh(surface_data_.measured_surface(), mesh_, partition().cell_of, cells,
                    exact_above_share_ * bound, evidence, from_mesh_, cache);
  for (const CellId c : cells) add_error(c, from_mesh_[c], bound);
}

void MeasuredCovering::add_error(CellId cell, const Farthest& farthest, double bound) {
  const double excess = static_cast<double>(farthest.distance) / bound;
  if (excess > errors_[cell].excess) errors_[cell] = {excess, excess, farthest.at};
}

std::vector<MetricValues> measure_metrics(const SurfaceData& surface_data, const Covering& covering,
                                          const LevelMesh& mesh, TriangleErrorCache* cache,
                                          bool is_proved) {
  const std::uint32_t n = mesh.cell_count();
  std::vector<CellId> cells(n);
  std::iota(cells.begin(), cells.end(), 0u);
  std::vector<ClosestPoint> closest;
  std::vector<Farthest> farthest;
  find_closest(surface_data.measured_surface(), mesh, cells, closest);
  surface_data.report_continuing();
  std::vector<std::size_t> first(n + 1, 0);
  for (CellId c = 0; c < n; ++c) first[c + 1] = first[c] + mesh.c_vertices_of.row(c).size();
  // Only the largest distance of each cell counts: of its c-vertices, its face nodes and its
  // triangles.
  farthest.resize(n);
  float largest = 0;
  for (CellId c = 0; c < n; ++c) {
    const auto c_vertices = mesh.c_vertices_of.row(c);
    for (std::size_t k = 0; k < c_vertices.size(); ++k) {
      const float distance = closest[first[c] + k].distance;
      if (distance > farthest[c].distance) farthest[c] = {distance, c_vertices[k]};
    }
    largest = std::max(largest, farthest[c].distance);
  }
  if (surface_data.face_nodes)
    farthest = measure_face_nodes(surface_data.measured_surface(), *surface_data.face_nodes, mesh,
                                  cells, 0, std::move(farthest));
  if (surface_data.isosurface != nullptr && !is_proved)
    measure_from_mesh(surface_data.measured_surface(), mesh, covering.partition().cell_of, cells,
                      static_cast<double>(largest), Evidence::samples, farthest, cache);
  surface_data.report_continuing();
  std::vector<MetricValues> values(n);
  for_each_chunk_reporting(
      n, kCoveredCellsPerChunk, surface_data.control, [&](std::size_t begin, std::size_t end) {
        surface_data.check_cancelled();
        for (std::size_t i = begin; i < end; ++i) {
          const auto c = static_cast<CellId>(i);
          const std::span<const ClosestPoint> own =
              std::span<const ClosestPoint>(closest).subspan(first[c], first[c + 1] - first[c]);
          const CellView cell = view_of(surface_data, covering, mesh, c, own, farthest[c].distance);
          for (std::size_t m = 0; m < kMetricCount; ++m)
            values[c][m] = evaluate(static_cast<Quantity>(m), cell);
        }
      });
  return values;
}

std::vector<MetricValues> MeasuredCovering::measure_metrics() const {
  return isoatlas::detail::measure_metrics(surface_data_, covering_, mesh_, sampled_errors_.get(),
                                           is_proved());
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
