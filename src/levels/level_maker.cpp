// SPDX-License-Identifier: Apache-2.0
#include "levels/level_maker.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "core/ranges.h"
#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "error/measure_mesh.h"
#include "levels/level.h"

namespace isoatlas::detail {
namespace {

constexpr int kMaxMeasuredRounds = 8;

// The goal with its lengths divided by `length`.
LevelGoal in_units_of(LevelGoal goal, double length) {
  for (Constraint& c : goal) {
    if (unit(c.quantity) == Unit::length) c.bound /= length;
  }
  return goal;
}

// A bound on the distance applies to all known distances: the metric tests some points of each
// cell, the measurement others.
void apply_measurement(LevelReport& report) {
  for (ConstraintResult& result : report.constraints) {
    if (result.constraint.quantity != Quantity::max_distance ||
        report.measured->maximum() <= result.reached)
      continue;
    const bool was_satisfied = result.satisfied;
    result.reached = report.measured->maximum();
    result.satisfied = result.reached <= result.constraint.bound;
    if (was_satisfied && !result.satisfied)
      result.reason =
          "satisfied at the points that refinement tests, but not at all samples of the "
          "measurement";
  }
}

bool satisfies_distance(const RefinedLevel& level) {
  return ranges::all_of(level.figures.constraints, [](const ConstraintResult& result) {
    return result.constraint.quantity != Quantity::max_distance || result.satisfied;
  });
}

// The numbers of vertices in a hierarchy with corners of the volume's box. In a level they follow
// the vertices on the surface, in the hierarchy those of level 0, so that levels share them.
struct CornersInside {
  std::uint32_t first = 0;     // number of the first corner
  std::uint32_t vertices = 0;  // of the level, on the surface
  std::uint32_t corners = 0;

  std::uint32_t id(std::uint32_t v) const {
    return v < first ? v : v < vertices ? v + corners : v - vertices + first;
  }
  // @param values  of the corners; empty: 0
  template <class T>
  void insert_corners(std::vector<T>& of_vertices, std::span<const T> values) const {
    const auto at = of_vertices.insert(of_vertices.begin() + first, corners, T{});
    std::copy(values.begin(), values.end(), at);
  }
};

bool is_complete(const ExtractOptions& options) {
  return !options.components.selects() && options.surface.interpolation == Interpolation::trilinear;
}

}  // namespace

LevelMaker::LevelMaker(const LevelSource& source, const ExtractOptions& options,
                       const RunControl& control)
    : source_(source),
      options_(options),
      control_(control),
      refiner_(
          source.surface, source.isosurface, source.coarser, source.options,
          {source.coarse.site, source.coarse.radius, source.coarse.placement, is_complete(options)},
          options.allow_self_intersections ? std::nullopt : std::optional(source.output_positions),
          options.adaptive_supersample) {}

Vec3 LevelMaker::to_output_space(Vec3 index) const {
  TriangleMesh one;
  one.positions.push_back(index);
  isoatlas::detail::to_output_space(one, source_.grid, options_);
  return one.positions[0];
}

// Converts from voxels to world lengths.
void LevelMaker::fill_report(const LevelGoal& goal, const LevelFigures& figures,
                             LevelReport& report) const {
  const double voxel = source_.grid.smallest_spacing();
  report.metrics = figures.metrics;
  for (std::size_t m = 0; m < kMetricCount; ++m) {
    if (unit(static_cast<Quantity>(m)) != Unit::length) continue;
    (*report.metrics)[m].maximum *= voxel;
    (*report.metrics)[m].mean *= voxel;
  }
  if (figures.distance_at_most) report.distance_at_most = *figures.distance_at_most * voxel;
  report.constraints = figures.constraints;
  for (std::size_t i = 0; i < goal.size(); ++i) {
    report.constraints[i].constraint = goal[i];
    if (unit(goal[i].quantity) == Unit::length) report.constraints[i].reached *= voxel;
  }
}

std::vector<float> LevelMaker::world_lengths(std::vector<float> voxels) const {
  for (float& length : voxels)
    length = static_cast<float>(length * source_.grid.smallest_spacing());
  return voxels;
}

void LevelMaker::fill_measurement(Measurement measured, LevelReport& report) const {
  report.measured = std::move(measured);
  for (OneSidedDistance* d : {&report.measured->mesh_to_surface, &report.measured->surface_to_mesh})
    d->farthest = to_volume(d->farthest, options_);
  transform_to(*report.measured, source_.grid, options_.space);
  apply_measurement(report);
}

void LevelMaker::describe_coarse(Hierarchy& hierarchy, LevelReport& report) {
  const TriangleMesh& mesh = source_.coarse.mesh;
  const LevelGoal& goal = options_.coarse;
  const LevelFigures figures = refiner_.describe_coarse(
      mesh.triangles, in_units_of(goal, source_.grid.smallest_spacing()), control_);
  fill_report(goal, figures, report);
  hierarchy.levels.front().distance = world_lengths(figures.distance);
  hierarchy.levels.front().distance.resize(hierarchy.levels.front().vertex_count, 0);
  if (options_.measure_samples > 0)
    fill_measurement(measure(mesh, source_.isosurface, options_.measure_samples, control_), report);
}

// In sample-index coordinates.
TriangleMesh LevelMaker::mesh_of(const RefinedLevel& refined) const {
  TriangleMesh mesh;
  mesh.positions =
      vertex_positions(source_.surface.complex(), refiner_.surfels(), refiner_.placement());
  mesh.triangles = refined.triangles;
  return mesh;
}

// Measures a level and refines it where a measured distance violates the bound, as long as cells
// there can become smaller; returns the best level found. Does nothing if refinement could not even
// satisfy the bound at its own sample points.
Measurement LevelMaker::refine_to_measured_bound(const LevelGoal& goal, RefinedLevel& refined,
                                                 const RunControl& control) {
  const LevelGoal in_voxels = in_units_of(goal, source_.grid.smallest_spacing());
  double bound = std::numeric_limits<double>::infinity();
  for (const Constraint& c : in_voxels) {
    if (c.quantity == Quantity::max_distance) bound = c.bound;
  }
  std::optional<Measurement> best;
  RefinedLevel best_level;
  std::shared_ptr<const Refiner::State> state_of_best;
  for (int round = 0;; ++round) {
    DistantSamples distant{bound, {}};
    Measurement measured =
        measure(mesh_of(refined), source_.isosurface, options_.measure_samples, distant, control);
    if (distant.corners.empty() || refined.vertex_limit_reached || !satisfies_distance(refined))
      return measured;
    if (!best || measured.maximum() < best->maximum()) {
      best = std::move(measured);
      best_level = refined;
      state_of_best = refiner_.save_state();
    }
    if (round == kMaxMeasuredRounds ||
        !refiner_.refine_at(distant.corners, in_voxels, options_.placement, refined, control))
      break;
  }
  refiner_.restore_state(*state_of_best);
  refined = std::move(best_level);
  return *best;
}

// All refined levels share one stage of the progress.
RunControl LevelMaker::control_of_level(std::size_t refined_before) const {
  RunControl out = control_;
  if (!out.progress) return out;
  const auto levels = static_cast<double>(std::max<std::size_t>(1, options_.refine.size()));
  out.progress = [report = control_.progress, refined_before, levels](std::string_view stage,
                                                                      double fraction) {
    report(stage, stage == "refine" ? (static_cast<double>(refined_before) + fraction) / levels
                                    : fraction);
  };
  return out;
}

void LevelMaker::add_level(const LevelGoal& goal, Hierarchy& hierarchy,
                           std::vector<LevelReport>& reports) {
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const RunControl control = control_of_level(reports.size() - 1);
  RefinedLevel refined = refiner_.refine(in_units_of(goal, source_.grid.smallest_spacing()),
                                         options_.placement, control);
  if (refined.unchanged_from_previous_level) {
    LevelReport same = reports.back();
    same.refine_rounds = 0;
    fill_report(goal, refined.figures, same);
    if (same.measured) apply_measurement(same);
    same.seconds = seconds();
    reports.push_back(std::move(same));
    Hierarchy::Level again = hierarchy.levels.back();
    if (options_.placement == Placement::balanced && again.own_positions.empty())
      again.own_positions = hierarchy.positions;
    hierarchy.levels.push_back(std::move(again));
    return;
  }
  LevelReport& report = reports.emplace_back();
  std::optional<Measurement> measured;
  if (options_.measure_samples > 0) measured = refine_to_measured_bound(goal, refined, control);
  fill_report(goal, refined.figures, report);
  report.certificate = refined.certificate;
  report.refine_rounds = refined.rounds;
  report.flips = refined.shape.flips;
  report.moves = refined.shape.moves;
  report.displacements = refined.shape.displacements;
  report.sites_for_intersections = refined.sites_for_intersections;

  const SurfaceComplex& surface = source_.surface.complex();
  const Partition& partition = refiner_.partition();
  TriangleMesh mesh = mesh_of(refined);
  for (const auto& [cell, excess] : refined.at_limit)
    report.at_limit.push_back({to_output_space(mesh.positions[cell]), excess});
  const MeshTopology topology = mesh_topology(mesh, control);
  report_continuing(control);
  if (measured) fill_measurement(std::move(*measured), report);
  finish_level(mesh, topology, partition.site, source_.surface, refiner_.obstacles(), goal,
               source_.grid, options_, report, control_);

  // The corners of the box follow the vertices of level 0 on the surface.
  const std::uint32_t vertices = partition.cell_count();
  const auto corners = static_cast<std::uint32_t>(mesh.positions.size()) - vertices;
  const CornersInside numbering{hierarchy.levels.front().vertex_count - corners, vertices, corners};
  // Appends new vertices; earlier ones are already there.
  TriangleMesh on_surface;
  for (auto v = static_cast<CellId>(hierarchy.positions.size() - corners); v < vertices; ++v)
    on_surface.positions.push_back(base_position(surface, refiner_.placement(), v));
  isoatlas::detail::to_output_space(on_surface, source_.grid, options_);
  hierarchy.positions.insert(hierarchy.positions.end(), on_surface.positions.begin(),
                             on_surface.positions.end());
  const std::vector<std::uint32_t> parents = refiner_.parents();
  for (std::size_t v = hierarchy.parent.size() - corners; v < parents.size(); ++v)
    hierarchy.parent.push_back(numbering.id(parents[v]));
  for (Triangle& t : mesh.triangles) {
    for (std::uint32_t& v : t) v = numbering.id(v);
  }
  Hierarchy::Level level;
  level.vertex_count = vertices + corners;
  level.triangles = std::move(mesh.triangles);
  level.cap_triangles = cap_count(report);
  level.distance = world_lengths(refined.figures.distance);
  numbering.insert_corners(level.distance, {});
  if (options_.placement == Placement::balanced) {
    level.own_positions.assign(mesh.positions.begin(), mesh.positions.begin() + vertices);
    numbering.insert_corners<Vec3>(level.own_positions,
                                   std::span(mesh.positions).subspan(vertices));
  }
  hierarchy.levels.push_back(std::move(level));
  report.seconds = seconds();
}

}  // namespace isoatlas::detail
