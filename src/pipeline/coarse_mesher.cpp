// SPDX-License-Identifier: Apache-2.0
#include "pipeline/coarse_mesher.h"

#include <algorithm>
#include <utility>

#include "core/vector_math.h"
#include "cover/halving_covering.h"
#include "mesh/outward.h"
#include "refine/relax.h"
#include "surface/area_vectors.h"

namespace isoatlas {
namespace {

// Vertices of the coarse level are moved this far from each other where they can be, times the shortest side of a grid cell: they stay
// where they are in all levels, and the triangles of fine ones have edges of about that side in noise. Supersampled cells have no room
// for more.
constexpr double kSeparation = 0.4;
constexpr int kRelaxRounds = 3;  // with those that must not be where they were moved to held

// Gives every marked component more sites, where it is farthest from the others: one, or from round 3 on all that are at least
// half as far as the farthest, so that few rounds suffice. @return false if there was no room for any
bool refine_components(const SurfaceComplex& complex, Covering& covering, const MeshTopology& topology,
                       const std::vector<std::uint8_t>& marked, int round, CertificateReport& certificate) {
  const Partition& partition = covering.partition();
  const std::vector<float>& distance = covering.distance();
  const std::uint32_t before = covering.site_count();
  const auto component_of = [&](CVertexId v) { return topology.component_of_vertex[partition.cell_of[v]]; };
  std::vector<CVertexId> farthest(topology.components.size(), kNone);
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

// Which way the piece of surface of each cell faces.
// @param outward  of c-vertices that stand for several; empty: none does
std::vector<Vec3> outward_of_cells(const SurfaceComplex& complex, const std::vector<Vec3>& outward, const Partition& partition) {
  if (outward.empty()) return area_vectors(complex, partition.cell_of, partition.cell_count());
  std::vector<Vec3> out(partition.cell_count());
  for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
    Vec3& sum = out[partition.cell_of[v]];
    sum = sum + outward[v];
  }
  return out;
}

}  // namespace

CoarseMesher::Stand::Stand(const SurfaceComplex& on, const CoveringOptions& options)
    : complex(on), graph(make_graph(on)), covering(graph, options), dual(complex, covering) {}

CoarseMesher::CoarseMesher(AdaptiveSurface& surface, Coarsened& coarser, const CoveringOptions& cover, const ExtractOptions& options)
    : surface_(surface), coarser_(coarser), cover_(cover), options_(options) {
  stand_ = std::make_unique<Stand>(is_coarser() ? coarser_.complex : surface_.complex(), cover_);
}

void CoarseMesher::cover(const RunControl& control) {
  auto& [complex, graph, covering, dual] = *stand_;
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

std::vector<ShapeObstacle> CoarseMesher::stays() const {
  std::vector<ShapeObstacle> out;
  for (const CVertexId v : sites()) {
    const bool met = out.size() < stays_.size() && stays_[out.size()] != 0;
    out.push_back(met ? ShapeObstacle::self_intersection : surface_.may_roam(v) ? ShapeObstacle::none : ShapeObstacle::crowded);
  }
  return out;
}

void CoarseMesher::mesh(LevelReport& report, const RunControl& told) {
  RunControl control = told;  // covers and certifies again, which is nobody's stage
  control.progress = nullptr;
  for (int round = 0;; ++round) {
    const SurfaceComplex& complex = stand_->complex;
    const Partition& partition = stand_->covering.partition();
    mesh_.triangles.clear();
    for (const DualTriangle& t : stand_->dual.triangles()) mesh_.triangles.push_back(t.cell);
    mesh_.positions.clear();
    for (const CVertexId v : partition.site) mesh_.positions.push_back(complex.positions[v]);
    relax_vertices(control);
    control.check_cancelled();
    topology_ = mesh_topology(mesh_);
    control.check_cancelled();
    const std::vector<std::uint8_t> turned =
        turned_components(mesh_.positions, mesh_.triangles, complex.spacing, topology_.component_of_vertex, topology_.components.size(),
                          outward_of_cells(complex, is_coarser() ? coarser_.outward : std::vector<Vec3>(), partition), 0);
    report.turned_components = static_cast<std::size_t>(std::count(turned.begin(), turned.end(), 1));
    bool again = report.turned_components > 0 && refine_components(complex, stand_->covering, topology_, turned, round, report.certificate);
    if (!again && !options_.allow_self_intersections) again = part(report, control);
    if (!again) break;
    stand_->dual.certify(report.certificate, control);
  }
}

// Moves vertices that are too close to each other for later levels to have good triangles there.
void CoarseMesher::relax_vertices(const RunControl& control) {
  const SurfaceComplex& surface = surface_.complex();
  const Vec3 s = surface.spacing;
  const std::vector<CVertexId> at = sites();
  std::vector<Vec3> points;
  std::vector<Roam> roam;
  std::vector<Vec3> start;
  shift_.resize(at.size());
  const double separation = kSeparation * std::min({s.x, s.y, s.z});
  for (std::size_t i = 0; i < at.size(); ++i) {
    start.push_back(scaled(surface.positions[at[i]], s));
    const bool stays = !surface_.may_roam(at[i]) || (i < stays_.size() && stays_[i]);
    points.push_back(stays ? start.back() : start.back() + shift_[i]);  // from where they were in the last round
    roam.push_back(stays ? Roam{start.back(), start.back()} : roam_of(surface.positions[at[i]], s));
  }
  const InterpolatedField* const field = options_.vertices_on_surface ? &surface_.field() : nullptr;
  std::vector<Vec3> positions;  // per c-vertex, those that vertices are at moved
  std::vector<CVertexId> movers;
  const auto move_c_vertices = [&] {
    positions = surface.positions;
    movers.clear();
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (!(points[i] == start[i])) movers.push_back(at[i]);
      mesh_.positions[i] = positions[at[i]] = displaced(surface, at[i], points[i] - start[i]);
    }
  };
  move_c_vertices();
  std::vector<std::uint8_t> fresh = meeting_.fresh(mesh_.positions, mesh_.triangles);  // for the others this was done in the last round
  for (int round = 1;; ++round) {
    relax(points, mesh_.triangles, roam, field, s, {1.0 / 3, separation}, control, fresh);
    control.check_cancelled();
    move_c_vertices();
    std::vector<CVertexId> back = surface_.stray(movers, positions, surface.positions);
    if (back.empty()) break;
    std::sort(back.begin(), back.end());
    std::vector<std::uint8_t> is_back(at.size(), 0);
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (!std::binary_search(back.begin(), back.end(), at[i])) continue;
      is_back[i] = 1;
      points[i] = start[i];
      roam[i] = {start[i], start[i]};
      mesh_.positions[i] = surface.positions[at[i]];
    }
    if (round == kRelaxRounds) break;
    for (std::size_t t = 0; t < fresh.size(); ++t) {
      const Triangle& c = mesh_.triangles[t];
      fresh[t] = is_back[c[0]] | is_back[c[1]] | is_back[c[2]];
    }
  }
  for (std::size_t i = 0; i < at.size(); ++i) shift_[i] = points[i] - start[i];
}

// Of each two triangles that meet where they should not the largest cell is divided. (All six: 2 to 10 % more triangles, twice as many
// bad ones, and a quarter less time in white noise.) Where cells are single c-vertices, more of these are needed: first those of the
// surface itself, then pieces that stay in their grid cells. Such pieces do not meet, but where vertices were moved.
// @return whether there is something new to look at
bool CoarseMesher::part(LevelReport& report, const RunControl& control) {
  meeting_.update(mesh_.positions, mesh_.triangles, control);
  Covering& covering = stand_->covering;
  const std::uint32_t before = covering.site_count();
  const std::vector<CellId> single = covering.shrink(meeting_.largest_corners(covering.reach()));
  covering.cover(control);  // also where components that were turned left radii too small to cover
  bool any = covering.site_count() > before;
  if (!single.empty()) any = part_single_cells(single, any, control) || any;
  report.parting_sites += stand_->covering.site_count() - before;
  return any;
}

// @param progress  whether other cells were made smaller
bool CoarseMesher::part_single_cells(std::span<const CellId> cells, bool progress, const RunControl& control) {
  const std::vector<CVertexId>& site = stand_->covering.partition().site;
  const std::vector<CVertexId> on_surface = sites();
  const std::vector<Fineness> fineness = surface_.fineness();
  std::vector<std::uint8_t> stands_for_several(stand_->complex.c_vertex_count(), 0);
  if (is_coarser()) {
    for (CVertexId v = 0; v < coarser_.region_of.size(); ++v) {
      const CVertexId r = coarser_.region_of[v];
      stands_for_several[r] |= coarser_.representative[r] != v;
    }
  }
  std::vector<CVertexId> to_cut, to_divide;
  std::vector<CellId> as_fine_as_can_be;
  for (const CellId c : cells) {
    if (stands_for_several[site[c]]) {
      to_cut.push_back(site[c]);
    } else if (fineness[on_surface[c]] == Fineness::faces) {
      to_divide.push_back(on_surface[c]);
    } else {
      as_fine_as_can_be.push_back(c);
    }
  }
  if (to_cut.empty() && to_divide.empty()) {
    if (progress) return true;
    stays_.resize(site.size(), 0);
    bool any = false;
    for (const CellId c : as_fine_as_can_be) any |= std::exchange(stays_[c], std::uint8_t{1}) == 0;
    return any;
  }
  if (!to_divide.empty()) {
    for (std::size_t i = 0; i < mesh_.positions.size(); ++i) {
      if (std::exchange(shift_[i], Vec3{}) != Vec3{}) surface_.move(on_surface[i], mesh_.positions[i]);
    }
    surface_.divide(to_divide);
  }
  // Sites stay, radii as well, unless that would leave something uncovered.
  const std::vector<CVertexId> now = site;
  std::vector<Covering::Radius> radii;
  for (CVertexId v = 0; v < stand_->covering.radius().size(); ++v) radii.push_back({v, stand_->covering.radius()[v]});
  if (is_coarser()) cut_regions(surface_.complex(), to_cut, coarser_, control);
  control.check_cancelled();
  stand_ = std::make_unique<Stand>(is_coarser() ? coarser_.complex : surface_.complex(), cover_);
  control.check_cancelled();
  stand_->covering.seed(now, radii);
  stand_->covering.ignore_events();
  stand_->covering.cover(control);
  return true;
}

}  // namespace isoatlas
