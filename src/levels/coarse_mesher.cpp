// SPDX-License-Identifier: Apache-2.0
#include "levels/coarse_mesher.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "complex/components.h"
#include "core/parallel.h"
#include "core/ranges.h"
#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "embedding/resolve_intersections.h"
#include "error/level_mesh.h"
#include "geometry/mesh_nesting.h"
#include "optimize/relax.h"
#include "voronoi/halving_covering.h"

namespace isoatlas::detail {
namespace {

// Vertices of the coarse level are moved at least this far apart where possible, in shortest sides
// of a grid cell. They keep these positions in all levels, and fine triangles have edges of about
// that length in noise. Supersampled grid cells have no room for more.
constexpr double kSeparation = 0.4;
constexpr int kRelaxRounds = 4;  // each around the vertices that were reverted in the last one

// Inserts sites in every marked component where it is farthest from its sites: one, or from round 3
// on all c-vertices at least half as far as the farthest, so that few rounds suffice. @return false
// if no site could be inserted
bool refine_components(const SurfaceComplex& complex, Covering& covering,
                       std::span<const ComponentId> component_of_cell,
                       const std::vector<std::uint8_t>& marked, int round,
                       CertificateReport& certificate) {
  const Partition& partition = covering.partition();
  const std::vector<float>& distance = covering.distance();
  const std::uint32_t before = covering.site_count();
  const auto component_of = [&](CVertexId v) { return component_of_cell[partition.cell_of[v]]; };
  std::vector<CVertexId> farthest(marked.size(), kNone);
  for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
    if (!marked[component_of(v)] || distance[v] == 0) continue;
    CVertexId& best = farthest[component_of(v)];
    if (best == kNone || distance[v] > distance[best]) best = v;
  }
  std::vector<CVertexId> chosen;
  for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
    const CVertexId best = farthest[component_of(v)];
    if (v == best ||
        (round >= 3 && best != kNone && distance[v] > 0 && distance[v] >= distance[best] / 2))
      chosen.push_back(v);
  }
  for (const CVertexId v : chosen) {
    covering.lower_radius(v, distance[v]);
    covering.insert(v);
  }
  certificate.repair_sites += covering.site_count() - before;
  return covering.site_count() > before;
}

// Per vertex, the triangles with a corner there.
SlackRows<std::uint32_t> triangles_around(std::span<const Triangle> triangles,
                                          std::size_t vertices) {
  std::vector<std::uint32_t> count(vertices, 0);
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t) ++count[v];
  }
  SlackRows<std::uint32_t> out;
  out.reserve(count);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t v : triangles[t]) out.push_back(v, t);
  }
  return out;
}

}  // namespace

CoarseMesher::CoarseState::CoarseState(const SurfaceComplex& surface_complex,
                                       const CoveringOptions& options, const RunControl& control)
    : complex(surface_complex),
      positions(surface_complex.positions),
      graph(make_graph(surface_complex, &control)),
      covering(graph, options),
      dual(complex, covering) {}

// Adapts to a complex that was refined.
void CoarseMesher::CoarseState::adapt_to(const RunControl& control) {
  std::vector<std::uint8_t> changed = rebuild_graph(graph, complex, &control);
  for (CVertexId v = 0; v < positions.size(); ++v)
    changed[v] |= !(positions[v] == complex.positions[v]);
  positions = complex.positions;
  covering.adapt_to(changed, std::vector<CVertexId>(covering.partition().site), control);
  covering.ignore_events();
  dual.adapt_to(changed);
}

CoarseMesher::CoarseMesher(AdaptiveSurface& surface, Coarsened& coarser,
                           const CoveringOptions& cover, const ExtractOptions& options,
                           OutputPositions output_positions)
    : surface_(surface),
      coarser_(coarser),
      cover_(cover),
      options_(options),
      tracker_(std::move(output_positions)) {
  state_ = std::make_unique<CoarseState>(is_coarser() ? coarser_.complex : surface_.complex(),
                                         cover_, surface_.control());
}

void CoarseMesher::cover(const RunControl& control) {
  auto& [complex, positions, graph, covering, dual] = *state_;
  std::vector<CVertexId> on_shared_faces;
  for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
    if (complex.on_boundary[v] == kOnSharedFace) on_shared_faces.push_back(v);
  }
  if (!on_shared_faces.empty()) covering.start_with(on_shared_faces, control);
  if (options_.covering.strategy == CoveringStrategy::halving) {
    cover_from(cover_by_halving(graph, cover_, control), graph, covering, control);
  } else {
    covering.cover(control);
  }
}

void CoarseMesher::certify(LevelReport& report, const RunControl& control) {
  state_->dual.certify(report.certificate, control);
}

std::vector<CVertexId> CoarseMesher::sites() const {
  std::vector<CVertexId> out = state_->covering.partition().site;
  if (is_coarser()) {
    for (CVertexId& v : out) v = coarser_.representative[v];
  }
  return out;
}

// Replaces the mesh by the current dual, with undisplaced vertices.
void CoarseMesher::update_mesh() {
  mesh_.triangles = to_triangles(state_->dual.triangles());
  mesh_.positions.clear();
  for (const CVertexId v : sites()) mesh_.positions.push_back(surface_.complex().positions[v]);
}

std::vector<ComponentId> CoarseMesher::components() const {
  std::vector<ComponentId> out;
  for (const CVertexId v : sites()) out.push_back(surface_.components().of_c_vertex[v]);
  return out;
}

// Level 0 while its self-intersections are resolved.
class CoarseMesher::Dual : public GrowingDual {
 public:
  Dual(CoarseMesher& mesher, CertificateReport& certificate, const RunControl& control)
      : mesher_(mesher), certificate_(certificate), control_(control) {}

  Covering& covering() override { return mesher_.state_->covering; }
  const SurfaceComplex& complex() const override { return mesher_.state_->complex; }
  void update() override {
    report_continuing(control_);
    mesher_.state_->dual.update(certificate_, control_);
    mesher_.update_mesh();
    control_.check_cancelled();
  }
  std::vector<Vec3> positions() const override { return mesher_.mesh_.positions; }
  std::vector<Triangle> triangles() const override { return mesher_.mesh_.triangles; }
  std::vector<CVertexId> sites_on_surface() const override { return mesher_.sites(); }
  bool repair_first() override {
    return mesher_.refine_inverted_components(round_++, certificate_);
  }
  bool subdivide(std::span<const CellId> single) override {
    return mesher_.refine_single_cells(single, control_);
  }

 private:
  CoarseMesher& mesher_;
  CertificateReport& certificate_;
  const RunControl& control_;
  int round_ = 0;
};

// Rounds only certify what has changed; a complete certificate follows at the end.
void CoarseMesher::mesh(LevelReport& report, const RunControl& caller_control) {
  const RunControl control =
      without_stages(caller_control);  // nested cover/certify calls must not report progress
  Dual dual(*this, report.certificate, control);
  do {
    if (options_.allow_self_intersections) {
      do dual.update();
      while (dual.repair_first());
    } else {
      const ResolvedIntersections resolved =
          resolve_intersections(dual, surface_, tracker_, control);
      report.sites_for_intersections += resolved.sites_for_intersections;
      report.certificate.repair_sites += resolved.sites_for_nesting;
    }
    state_->dual.certify(report.certificate, control);
  } while (state_->covering.site_count() > mesh_.positions.size());
  update_mesh();
  RunControl quiet = control;  // parallel tasks must not report progress
  quiet.progress = nullptr;
  run_both([&] { relax_vertices(quiet); },
           [&] {  // does not depend on positions
             topology_ = mesh_topology(mesh_, quiet);
             if (were_regions_split_) certify_regions(surface_.complex(), coarser_, quiet);
           });
}

CoarseLevel CoarseMesher::take_level() {
  coarser_.region_of = {};
  coarser_.triangles = {};
  return {std::move(mesh_), std::move(topology_), std::move(placement_),
          state_->covering.partition().site, state_->covering.radius()};
}

std::vector<std::uint8_t> CoarseMesher::inverted_components(
    std::span<const ComponentId> component_of) const {
  const std::vector<std::int8_t>& wanted = surface_.nesting().facing;
  const std::vector<std::int8_t> facing = mesh_facing(
      mesh_.positions, mesh_.triangles, component_of, open_flags(surface_.components()));
  std::vector<std::uint8_t> inverted(wanted.size());
  for (std::size_t c = 0; c < wanted.size(); ++c) inverted[c] = facing[c] != wanted[c];
  return inverted;
}

Nesting CoarseMesher::nesting(std::span<const ComponentId> component_of) const {
  return mesh_nesting(mesh_.positions, mesh_.triangles, component_of,
                      open_flags(surface_.components()), surface_.control());
}

// Vertices on shared faces are too close together for well-shaped triangles, so there is no reason
// to move others away from them and off the surface, where later levels could not correct them.
bool CoarseMesher::is_next_to_shared_face(std::uint32_t vertex, std::span<const CVertexId> at,
                                          const SlackRows<std::uint32_t>& triangles_of) const {
  return ranges::any_of(triangles_of.row(vertex), [&](std::uint32_t t) {
    return ranges::any_of(mesh_.triangles[t], [&](std::uint32_t corner) {
      return surface_.complex().on_boundary[at[corner]] == kOnSharedFace;
    });
  });
}

// Moves vertices that are too close to each other for later levels to have well-shaped triangles
// there, and improves the triangles of this level. Where triangles or surfels intersect afterwards,
// or a component is inverted, vertices are first moved back half of the way, then completely. Their
// neighbourhood is tried again, in every other round without pushing, which would repeat the same
// moves.
void CoarseMesher::relax_vertices(const RunControl& control) {
  const SurfaceComplex& surface = surface_.complex();
  const Vec3 s = surface.spacing;
  const std::vector<CVertexId> at = sites();
  const std::vector<ComponentId> component_of = components();
  const SlackRows<std::uint32_t> triangles_of = triangles_around(mesh_.triangles, at.size());
  std::vector<Vec3> start;
  std::vector<MoveBounds> bounds;
  for (std::uint32_t i = 0; i < at.size(); ++i) {
    const Vec3 position = surface.positions[at[i]];
    start.push_back(to_metric(position, s));
    bounds.push_back(surface_.is_movable(at[i]) && !is_next_to_shared_face(i, at, triangles_of)
                         ? move_bounds_of(position, s)
                         : MoveBounds{start.back(), start.back()});
  }
  control.check_cancelled();
  const InterpolatedField* const field = options_.vertices_on_surface ? &surface_.field() : nullptr;
  RelaxGoal goal{1.0 / 3, kSeparation * std::min({s.x, s.y, s.z})};

  // positions: per c-vertex of the surface, with those of vertices displaced
  std::vector<Vec3> points = start, positions = surface.positions;
  const auto move_vertex = [&](std::uint32_t i, Vec3 point) {
    points[i] = point;
    mesh_.positions[i] = positions[at[i]] = displaced_position(surface, at[i], point - start[i]);
  };
  placement_.fixed.assign(at.size(), 0);
  std::vector<std::uint32_t> candidates(mesh_.triangles.size());
  std::iota(candidates.begin(), candidates.end(), 0u);
  for (int round = 0; round < kRelaxRounds; ++round) {
    goal.push = round % 2 == 0;
    control.check_cancelled();
    const std::vector<Vec3> before = points;
    const std::vector<std::uint32_t> moved = relax(
        points, mesh_.triangles, triangles_of, [&](std::uint32_t i) { return bounds[i]; }, field, s,
        goal, control, candidates);
    std::vector<Vec3> positions_before;  // of the moved vertices
    for (const std::uint32_t i : moved) {
      positions_before.push_back(positions[at[i]]);
      move_vertex(i, points[i]);
    }
    std::vector<std::uint8_t> revert_count(at.size(), 0);
    for (std::vector<std::uint32_t> last = moved;
         !last.empty();) {  // nothing intersected before these moved
      const std::vector<std::uint8_t> is_reverted =
          find_moves_to_revert(moved, positions_before, positions, last, component_of, control);
      last.clear();
      for (const std::uint32_t i : moved) {
        if (is_reverted[i] == 0 || points[i] == before[i]) continue;
        last.push_back(i);
        move_vertex(i, revert_count[i]++ == 0 ? 0.5 * (points[i] + before[i]) : before[i]);
      }
    }
    candidates.clear();
    for (const std::uint32_t i : moved) {
      placement_.fixed[i] = revert_count[i] > 1 ? 3 : 0;
      if (revert_count[i] > 0)
        candidates.insert(candidates.end(), triangles_of.row(i).begin(), triangles_of.row(i).end());
    }
    ranges::sort(candidates);
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
  }
  if (!options_.allow_self_intersections &&
      nesting(component_of) != surface_.nesting()) {  // rare: return to the certified positions
    for (std::uint32_t i = 0; i < at.size(); ++i) move_vertex(i, start[i]);
  }
  placement_.anchor = at;
  placement_.displacement.clear();
  for (std::size_t i = 0; i < at.size(); ++i)
    placement_.displacement.push_back(points[i] - start[i]);
}

// Per vertex, 1 if its move must be reverted.
// @param before     for each moved vertex, its position before the move
// @param positions  per c-vertex of the surface
// @param check      the vertices moved since surfels were known not to intersect
std::vector<std::uint8_t> CoarseMesher::find_moves_to_revert(
    std::span<const std::uint32_t> moved, std::span<const Vec3> before, std::span<Vec3> positions,
    std::span<const std::uint32_t> check, std::span<const ComponentId> component_of,
    const RunControl& control) {
  const std::vector<CVertexId> at = sites();
  std::vector<std::uint8_t> out(at.size(), 0);
  const auto c_vertices = [&](std::span<const std::uint32_t> vertices) {
    std::vector<CVertexId> of;
    for (const std::uint32_t i : vertices) of.push_back(at[i]);
    return of;
  };
  std::vector<CVertexId> conflicting =
      surface_.find_conflicting_moves(c_vertices(moved), before, positions, c_vertices(check));
  std::sort(conflicting.begin(), conflicting.end());
  for (const std::uint32_t i : moved)
    out[i] = std::binary_search(conflicting.begin(), conflicting.end(), at[i]);
  bool any = !conflicting.empty();
  if (!options_.allow_self_intersections) {
    for (const std::uint32_t i : tracker_.update(mesh_.positions, mesh_.triangles, control))
      out[i] = 1;
    any = any || tracker_.pair_count() > 0;
  }
  if (any) return out;
  control.check_cancelled();
  const std::vector<std::uint8_t> inverted = inverted_components(component_of);
  for (const std::uint32_t i : moved) out[i] = inverted[component_of[i]];
  return out;
}

// @return whether anything has changed
bool CoarseMesher::refine_inverted_components(int round, CertificateReport& certificate) {
  const std::vector<ComponentId> component_of = components();
  const std::vector<std::uint8_t> inverted = inverted_components(component_of);
  return ranges::count(inverted, std::uint8_t{1}) > 0 &&
         refine_components(state_->complex, state_->covering, component_of, inverted, round,
                           certificate);
}

// The regions at the sites of the cells that represent several c-vertices.
std::vector<CVertexId> CoarseMesher::regions_to_split(std::span<const CellId> cells) const {
  if (!is_coarser()) return {};
  std::vector<std::uint8_t> has_several_c_vertices(state_->complex.c_vertex_count(), 0);
  for (CVertexId v = 0; v < coarser_.region_of.size(); ++v) {
    const CVertexId r = coarser_.region_of[v];
    has_several_c_vertices[r] |= coarser_.representative[r] != v;
  }
  std::vector<CVertexId> out;
  for (const CellId c : cells) {
    const CVertexId r = state_->covering.partition().site[c];
    if (has_several_c_vertices[r]) out.push_back(r);
  }
  return out;
}

// Refines around cells that are single c-vertices: splits regions into the c-vertices that they
// represent or, if no region can be split, subdivides the faces around c-vertices of the surface.
// @return whether anything was refined
bool CoarseMesher::refine_single_cells(std::span<const CellId> cells, const RunControl& control) {
  const std::vector<CVertexId> to_split = regions_to_split(cells);
  std::vector<CVertexId> to_subdivide;
  if (to_split.empty()) {
    const std::vector<CVertexId> on_surface = sites();
    for (const CellId c : cells) to_subdivide.push_back(on_surface[c]);
    to_subdivide = filter_subdividable(surface_, std::move(to_subdivide));
    if (to_subdivide.empty()) return false;
    surface_.subdivide(to_subdivide);
  }
  report_continuing(control);
  if (is_coarser()) {
    split_regions(surface_.complex(), to_split,
                  to_subdivide.empty() ? std::span<const CVertexId>() : surface_.touched(),
                  coarser_, control);
    were_regions_split_ = true;
  }
  report_continuing(control);
  state_->adapt_to(control);
  state_->covering.cover(control);
  return true;
}

}  // namespace isoatlas::detail
