// SPDX-License-Identifier: Apache-2.0
#include "levels/coarse_mesher.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "complex/components.h"
#include "core/parallel.h"
#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "embedding/resolve_intersections.h"
#include "error/level_mesh.h"
#include "geometry/mesh_nesting.h"
#include "optimize/relax.h"
#include "voronoi/halving_covering.h"

namespace isoatlas::detail {
namespace {

// Vertices of the coarse level are moved this far from each other where they can be, times the shortest side of a grid cell: they stay
// where they are in all levels, and the triangles of fine ones have edges of about that side in noise. Supersampled cells have no room
// for more.
constexpr double kSeparation = 0.4;
constexpr int kRelaxRounds = 4;  // each around what had to go back in the last one

// Gives every marked component more sites, where it is farthest from the others: one, or from round 3 on all that are at least
// half as far as the farthest, so that few rounds suffice. @return false if there was no room for any
bool refine_components(const SurfaceComplex& complex, Covering& covering, std::span<const ComponentId> component_of_cell,
                       const std::vector<std::uint8_t>& marked, int round, CertificateReport& certificate) {
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
    if (v == best || (round >= 3 && best != kNone && distance[v] > 0 && distance[v] >= distance[best] / 2)) chosen.push_back(v);
  }
  for (const CVertexId v : chosen) {
    covering.lower_radius(v, distance[v]);
    covering.insert(v);
  }
  certificate.repair_sites += covering.site_count() - before;
  return covering.site_count() > before;
}

// Per vertex, the triangles with a corner there.
SlackRows<std::uint32_t> triangles_around(std::span<const Triangle> triangles, std::size_t vertices) {
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

CoarseMesher::Stand::Stand(const SurfaceComplex& on, const CoveringOptions& options, const RunControl& control)
    : complex(on), positions(on.positions), graph(make_graph(on, &control)), covering(graph, options), dual(complex, covering) {}

// The complex is finer now.
void CoarseMesher::Stand::continue_on(const RunControl& control) {
  std::vector<std::uint8_t> changed = remake_graph(graph, complex, &control);
  for (CVertexId v = 0; v < positions.size(); ++v) changed[v] |= !(positions[v] == complex.positions[v]);
  positions = complex.positions;
  covering.adapt_to(changed, std::vector<CVertexId>(covering.partition().site), control);
  covering.ignore_events();
  dual.adapt_to(changed);
}

CoarseMesher::CoarseMesher(AdaptiveSurface& surface, Coarsened& coarser, const CoveringOptions& cover, const ExtractOptions& options,
                           WrittenPositions written)
    : surface_(surface), coarser_(coarser), cover_(cover), options_(options), meeting_(std::move(written)) {
  stand_ = std::make_unique<Stand>(is_coarser() ? coarser_.complex : surface_.complex(), cover_, surface_.control());
}

void CoarseMesher::cover(const RunControl& control) {
  auto& [complex, positions, graph, covering, dual] = *stand_;
  if (options_.covering == CoveringStrategy::halving) {
    cover_from(cover_by_halving(graph, cover_, control), graph, covering, control);
  } else {
    covering.cover(control);
  }
}

void CoarseMesher::certify(LevelReport& report, const RunControl& control) { stand_->dual.certify(report.certificate, control); }

std::vector<CVertexId> CoarseMesher::sites() const {
  std::vector<CVertexId> out = stand_->covering.partition().site;
  if (is_coarser()) {
    for (CVertexId& v : out) v = coarser_.representative[v];
  }
  return out;
}

// What the dual is now, before its vertices are moved.
void CoarseMesher::take_mesh() {
  mesh_.triangles = to_triangles(stand_->dual.triangles());
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

  Covering& covering() override { return mesher_.stand_->covering; }
  void update() override {
    report_going_on(control_);
    mesher_.stand_->dual.update(certificate_, control_);
    mesher_.take_mesh();
    control_.check_cancelled();
  }
  std::vector<Vec3> positions() const override { return mesher_.mesh_.positions; }
  std::vector<Triangle> triangles() const override { return mesher_.mesh_.triangles; }
  std::vector<CVertexId> sites_on_surface() const override { return mesher_.sites(); }
  bool repair_first() override { return mesher_.mend_turned_components(round_++, certificate_); }
  bool subdivide(std::span<const CellId> single) override { return mesher_.make_finer(single, control_); }

 private:
  CoarseMesher& mesher_;
  CertificateReport& certificate_;
  const RunControl& control_;
  int round_ = 0;
};

// In rounds only what changed is certified; everything once at the end.
void CoarseMesher::mesh(LevelReport& report, const RunControl& told) {
  const RunControl control = without_stages(told);  // covers and certifies again
  Dual dual(*this, report.certificate, control);
  do {
    if (options_.allow_self_intersections) {
      do dual.update();
      while (dual.repair_first());
    } else {
      const ResolvedIntersections resolved = resolve_intersections(dual, surface_, meeting_, control);
      report.parting_sites += resolved.sites_for_intersections;
      report.certificate.repair_sites += resolved.sites_for_nesting;
    }
    stand_->dual.certify(report.certificate, control);
  } while (stand_->covering.site_count() > mesh_.positions.size());
  take_mesh();
  RunControl quiet = control;  // what runs beside something else tells nobody
  quiet.progress = nullptr;
  run_both([&] { relax_vertices(quiet); },
           [&] {  // what does not depend on where vertices are
             topology_ = mesh_topology(mesh_, quiet);
             if (were_regions_cut_) certify_regions(surface_.complex(), coarser_, quiet);
           });
}

CoarseLevel CoarseMesher::take_level() {
  coarser_.region_of = {};
  coarser_.triangles = {};
  return {std::move(mesh_), std::move(topology_), std::move(placement_), stand_->covering.partition().site, stand_->covering.radius()};
}

std::vector<std::uint8_t> CoarseMesher::turned_components(std::span<const ComponentId> component_of) const {
  const std::vector<std::int8_t>& wanted = surface_.nesting().facing;
  const std::vector<std::int8_t> facing = mesh_facing(mesh_.positions, mesh_.triangles, component_of, open_flags(surface_.components()));
  std::vector<std::uint8_t> turned(wanted.size());
  for (std::size_t c = 0; c < wanted.size(); ++c) turned[c] = facing[c] != wanted[c];
  return turned;
}

Nesting CoarseMesher::nesting(std::span<const ComponentId> component_of) const {
  return mesh_nesting(mesh_.positions, mesh_.triangles, component_of, open_flags(surface_.components()), surface_.control());
}

// Moves vertices that are too close to each other for later levels to have good triangles there, and for good triangles in this one. Where
// triangles or surfels meet then, or a component is inside out, vertices go back half of the way, and then all of it. What is around tries
// again, every other time without pushing, which would go the same way again.
void CoarseMesher::relax_vertices(const RunControl& control) {
  const SurfaceComplex& surface = surface_.complex();
  const Vec3 s = surface.spacing;
  const std::vector<CVertexId> at = sites();
  const std::vector<ComponentId> component_of = components();
  std::vector<Vec3> start;
  std::vector<MoveBounds> bounds;
  for (const CVertexId v : at) {
    start.push_back(scaled(surface.positions[v], s));
    bounds.push_back(surface_.is_movable(v) ? move_bounds_of(surface.positions[v], s) : MoveBounds{start.back(), start.back()});
  }
  control.check_cancelled();
  const SlackRows<std::uint32_t> triangles_of = triangles_around(mesh_.triangles, at.size());
  const InterpolatedField* const field = options_.vertices_on_surface ? &surface_.field() : nullptr;
  RelaxGoal goal{1.0 / 3, kSeparation * std::min({s.x, s.y, s.z})};

  std::vector<Vec3> points = start, positions = surface.positions;  // positions: per c-vertex, those that vertices are at moved
  const auto move_to = [&](std::uint32_t i, Vec3 point) {
    points[i] = point;
    mesh_.positions[i] = positions[at[i]] = displaced_position(surface, at[i], point - start[i]);
  };
  placement_.fixed.assign(at.size(), 0);
  std::vector<std::uint32_t> look(mesh_.triangles.size());
  std::iota(look.begin(), look.end(), 0u);
  for (int round = 0; round < kRelaxRounds; ++round) {
    goal.push = round % 2 == 0;
    control.check_cancelled();
    const std::vector<Vec3> before = points;
    const std::vector<std::uint32_t> moved = relax(
        points, mesh_.triangles, triangles_of, [&](std::uint32_t i) { return bounds[i]; }, field, s, goal, control, look);
    std::vector<Vec3> positions_before;  // of those that moved
    for (const std::uint32_t i : moved) {
      positions_before.push_back(positions[at[i]]);
      move_to(i, points[i]);
    }
    std::vector<std::uint8_t> times_back(at.size(), 0);
    for (std::vector<std::uint32_t> last = moved; !last.empty();) {  // before these moved, nothing intersected
      const std::vector<std::uint8_t> goes_back = must_go_back(moved, positions_before, positions, last, component_of, control);
      last.clear();
      for (const std::uint32_t i : moved) {
        if (goes_back[i] == 0 || points[i] == before[i]) continue;
        last.push_back(i);
        move_to(i, times_back[i]++ == 0 ? 0.5 * (points[i] + before[i]) : before[i]);
      }
    }
    look.clear();
    for (const std::uint32_t i : moved) {
      placement_.fixed[i] = times_back[i] > 1 ? 3 : 0;
      if (times_back[i] > 0) look.insert(look.end(), triangles_of.row(i).begin(), triangles_of.row(i).end());
    }
    std::ranges::sort(look);
    look.erase(std::unique(look.begin(), look.end()), look.end());
  }
  if (!options_.allow_self_intersections && nesting(component_of) != surface_.nesting()) {  // hardly ever: as it was certified
    for (std::uint32_t i = 0; i < at.size(); ++i) move_to(i, start[i]);
  }
  placement_.anchor = at;
  placement_.displacement.clear();
  for (std::size_t i = 0; i < at.size(); ++i) placement_.displacement.push_back(points[i] - start[i]);
}

// Per vertex, 1 if it must not be where it was moved to.
// @param before     where those that moved were, one by one
// @param positions  per c-vertex of the surface
// @param look       those that moved since no surfels intersected
std::vector<std::uint8_t> CoarseMesher::must_go_back(std::span<const std::uint32_t> moved, std::span<const Vec3> before,
                                                     std::span<Vec3> positions, std::span<const std::uint32_t> look,
                                                     std::span<const ComponentId> component_of, const RunControl& control) {
  const std::vector<CVertexId> at = sites();
  std::vector<std::uint8_t> out(at.size(), 0);
  const auto c_vertices = [&](std::span<const std::uint32_t> vertices) {
    std::vector<CVertexId> of;
    for (const std::uint32_t i : vertices) of.push_back(at[i]);
    return of;
  };
  std::vector<CVertexId> back = surface_.find_conflicting_moves(c_vertices(moved), before, positions, c_vertices(look));
  std::sort(back.begin(), back.end());
  for (const std::uint32_t i : moved) out[i] = std::binary_search(back.begin(), back.end(), at[i]);
  bool any = !back.empty();
  if (!options_.allow_self_intersections) {
    for (const std::uint32_t i : meeting_.update(mesh_.positions, mesh_.triangles, control)) out[i] = 1;
    any = any || meeting_.pair_count() > 0;
  }
  if (any) return out;
  control.check_cancelled();
  const std::vector<std::uint8_t> turned = turned_components(component_of);
  for (const std::uint32_t i : moved) out[i] = turned[component_of[i]];
  return out;
}

// @return whether there is something new to look at
bool CoarseMesher::mend_turned_components(int round, CertificateReport& certificate) {
  const std::vector<ComponentId> component_of = components();
  const std::vector<std::uint8_t> turned = turned_components(component_of);
  return std::ranges::count(turned, std::uint8_t{1}) > 0 &&
         refine_components(stand_->complex, stand_->covering, component_of, turned, round, certificate);
}

// The regions at the sites of cells that stand for several c-vertices.
std::vector<CVertexId> CoarseMesher::regions_to_cut(std::span<const CellId> cells) const {
  if (!is_coarser()) return {};
  std::vector<std::uint8_t> stands_for_several(stand_->complex.c_vertex_count(), 0);
  for (CVertexId v = 0; v < coarser_.region_of.size(); ++v) {
    const CVertexId r = coarser_.region_of[v];
    stands_for_several[r] |= coarser_.representative[r] != v;
  }
  std::vector<CVertexId> out;
  for (const CellId c : cells) {
    const CVertexId r = stand_->covering.partition().site[c];
    if (stands_for_several[r]) out.push_back(r);
  }
  return out;
}

// For cells that are single c-vertices: regions become the c-vertices that they stand for; if there are none to cut, the faces around
// c-vertices of the surface are subdivided. @return whether there was anything to do
bool CoarseMesher::make_finer(std::span<const CellId> cells, const RunControl& control) {
  const std::vector<CVertexId> to_cut = regions_to_cut(cells);
  std::vector<CVertexId> to_divide;
  if (to_cut.empty()) {
    const std::vector<CVertexId> on_surface = sites();
    for (const CellId c : cells) to_divide.push_back(on_surface[c]);
    to_divide = filter_subdividable(surface_, std::move(to_divide));
    if (to_divide.empty()) return false;
    surface_.subdivide(to_divide);
  }
  report_going_on(control);
  if (is_coarser()) {
    cut_regions(surface_.complex(), to_cut, to_divide.empty() ? std::span<const CVertexId>() : surface_.touched(), coarser_, control);
    were_regions_cut_ = true;
  }
  report_going_on(control);
  stand_->continue_on(control);
  stand_->covering.cover(control);
  return true;
}

}  // namespace isoatlas::detail
