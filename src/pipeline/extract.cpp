// SPDX-License-Identifier: Apache-2.0
// The place to start reading: volume -> surface complex -> coarser complex -> covering -> certified dual -> checked mesh -> finer levels.
#include "isoatlas/extract.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <new>
#include <numeric>
#include <span>
#include <stdexcept>

#include "core/parallel.h"
#include "core/vector_math.h"
#include "cover/repair.h"
#include "mesh/outward.h"
#include "partition/coarsen.h"
#include "refine/refiner.h"
#include "surface/area_vectors.h"
#include "surface/components.h"
#include "surface/parse_surface.h"
#include "volume/sample_type.h"

namespace isoatlas {
namespace {

// The coarser complex: blocks of four voxels, but well below the largest radius, so that its c-vertices leave the covering a
// choice; below one and a half voxels blocks gain nothing and the covering works on the full complex.
constexpr double kBlockVoxels = 4;
constexpr double kBlocksPerRadius = 4;
constexpr double kLeastBlockVoxels = 1.5;

constexpr double kLargestAnisotropy = 1e6;

class StageClock {
 public:
  explicit StageClock(ExtractReport& report) : report_(report), start_(Clock::now()), last_(start_) {}
  void finished(const char* stage) {
    const auto now = Clock::now();
    report_.seconds.push_back({stage, std::chrono::duration<double>(now - last_).count()});
    report_.total_seconds = std::chrono::duration<double>(now - start_).count();
    last_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  ExtractReport& report_;
  Clock::time_point start_, last_;
};

void require(bool good, const std::string& message) {
  if (!good) throw Error(ErrorCode::bad_argument, message);
}

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", x);
  return text;
}

void check_arguments(const VolumeView& volume, const ExtractOptions& options) {
  const Grid& grid = volume.grid;
  for (int a = 0; a < 3; ++a) {
    require(grid.size[a] >= 2 && grid.size[a] < kNone - 1,
            std::string("the volume has ") + std::to_string(grid.size[a]) + " samples along " + "xyz"[a] + ", expected 2 to 2^32 - 3");
  }
  for (const double s : {grid.spacing.x, grid.spacing.y, grid.spacing.z}) {
    require(std::isfinite(s) && s > 0, "spacing " + number(s) + " is not a positive length");
  }
  const double largest = std::max({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  require(largest <= kLargestAnisotropy * grid.smallest_spacing(), "spacings " + number(grid.smallest_spacing()) + " and " +
                                                                       number(largest) + " differ by more than a factor of " +
                                                                       number(kLargestAnisotropy));
  const auto is_finite = [](Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); };
  const auto& axes = grid.direction;
  require(is_finite(grid.origin) && is_finite(axes[0]) && is_finite(axes[1]) && is_finite(axes[2]),
          "origin and direction must be finite numbers");
  require(std::fabs(dot(axes[0], cross(axes[1], axes[2]))) > 1e-6, "the direction's axes lie in a plane");
  require(volume.samples != nullptr, "the volume has no samples");
  visit_sample_type(volume.type, [](auto*) {});  // throws if it is none
  require(std::isfinite(options.isovalue), "the isovalue is not a finite number");
  require(!options.max_radius || (std::isfinite(*options.max_radius) && *options.max_radius > 0),
          "the largest radius must be a positive length");
  require(!options.event_persistence || (std::isfinite(*options.event_persistence) && *options.event_persistence >= 0),
          "the event persistence must be a length >= 0");
}

[[noreturn]] void throw_empty(const VolumeView& volume, const ExtractOptions& options) {
  const SampleSummary s = summarize(volume);
  if (s.finite_count == 0) throw Error(ErrorCode::empty_surface, "no sample of the volume is finite");
  throw Error(ErrorCode::empty_surface, "no surface at isovalue " + number(options.isovalue) + ": samples range from " + number(s.minimum) +
                                            " to " + number(s.maximum) + ", so all of them are on one side");
}

// Per component, the topology counted on the finished triangles must be that of the reference. `component_of` says which
// reference component each mesh vertex stands on.
void check_mesh(const MeshTopology& mesh, const Components& reference, const std::vector<ComponentId>& component_of) {
  const auto require_internal = [](bool good, const std::string& what) {
    if (!good) throw Error(ErrorCode::internal, "the finished mesh failed its check: " + what);
  };
  require_internal(mesh.unused_vertices == 0, std::to_string(mesh.unused_vertices) + " vertices without a triangle");
  require_internal(mesh.is_manifold(), std::to_string(mesh.non_manifold_edges) + " edges and " +
                                           std::to_string(mesh.non_manifold_vertices) + " vertices are not manifold, " +
                                           std::to_string(mesh.degenerate_triangles) + " triangles repeat a vertex");
  require_internal(mesh.is_oriented(), std::to_string(mesh.inconsistent_edges) + " edges between triangles of opposite orientation");
  require_internal(mesh.components.size() == reference.topology.size(),
                   std::to_string(mesh.components.size()) + " components instead of " + std::to_string(reference.topology.size()));
  std::vector<std::uint32_t> counterpart(reference.topology.size(), kNone);
  for (std::size_t v = 0; v < component_of.size(); ++v) {
    std::uint32_t& c = counterpart[component_of[v]];
    if (c == kNone) c = mesh.component_of_vertex[v];
    require_internal(c == mesh.component_of_vertex[v], "vertex " + std::to_string(v) + " hangs together with the wrong component");
  }
  for (std::size_t c = 0; c < counterpart.size(); ++c) {
    require_internal(counterpart[c] != kNone, "component " + std::to_string(c) + " is missing");
    const ComponentTopology& want = reference.topology[c];
    const ComponentTopology& got = mesh.components[counterpart[c]];
    require_internal(want == got, "component " + std::to_string(c) + " has Euler characteristic " +
                                      std::to_string(got.euler_characteristic) + " and " + std::to_string(got.boundary_loops) +
                                      " boundary loops instead of " + std::to_string(want.euler_characteristic) + " and " +
                                      std::to_string(want.boundary_loops));
  }
}

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
std::vector<Vec3> outward_of_cells(const SurfaceComplex& complex, const Coarsened& coarser, const Partition& partition) {
  if (coarser.representative.empty()) return area_vectors(complex, partition.cell_of, partition.cell_count());
  std::vector<Vec3> out(partition.cell_count());
  for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
    Vec3& sum = out[partition.cell_of[v]];
    sum = sum + coarser.outward[v];
  }
  return out;
}

std::vector<Triangle> to_triangles(std::span<const DualTriangle> dual) {
  std::vector<Triangle> triangles;
  triangles.reserve(dual.size());
  for (const DualTriangle& t : dual) triangles.push_back(t.cell);
  return triangles;
}

// A goal with its lengths as multiples of `length`.
LevelGoal in_units_of(LevelGoal goal, double length) {
  for (Constraint& c : goal) {
    if (unit(c.quantity) == Unit::length) c.bound /= length;
  }
  return goal;
}

Vec3 to_space(Vec3 p, const Grid& grid, Space space) {
  TriangleMesh one;
  one.positions.push_back(p);
  transform_to(one, grid, space);
  return one.positions[0];
}

// Where a level's vertices sit, in sample-index coordinates. `at`: per vertex, the c-vertex it is on or over.
std::vector<Vec3> positions_of(const SurfaceComplex& surface, const std::vector<CVertexId>& at, const Refiner& refiner) {
  std::vector<Vec3> out;
  out.reserve(at.size());
  const std::vector<float>& offset = refiner.places().offset;
  for (CellId c = 0; c < at.size(); ++c) {
    Vec3 p = surface.positions[at[c]];
    if (!offset.empty()) {
      const Vec3 n = refiner.surfels().normal[at[c]], s = surface.spacing;
      const auto d = static_cast<double>(offset[c]);
      p = p + Vec3{d * n.x / s.x, d * n.y / s.y, d * n.z / s.z};
    }
    out.push_back(p);
  }
  return out;
}

// The end of every level: the topology check, then into the output's space, where shape is measured.
void finish_level(TriangleMesh& mesh, const MeshTopology& topology, std::span<const CVertexId> sites, const Components& reference,
                  const Grid& grid, Space space, LevelReport& report) {
  std::vector<ComponentId> component_of;
  component_of.reserve(sites.size());
  for (const CVertexId v : sites) component_of.push_back(reference.of_c_vertex[v]);
  check_mesh(topology, reference, component_of);
  report.topology = summarize(topology.components);
  report.vertices = mesh.positions.size();
  report.triangles = mesh.triangles.size();

  // Shape is a matter of world lengths, whatever the space of the output.
  TriangleMesh world = space == Space::voxel ? mesh : TriangleMesh{};
  TriangleMesh& measured = space == Space::voxel ? world : mesh;
  transform_to(measured, grid, space == Space::voxel ? Space::lps : space);
  report.quality = mesh_quality(measured);
}

}  // namespace

bool LevelReport::all_met() const {
  return std::all_of(constraints.begin(), constraints.end(), [](const ConstraintResult& c) { return c.met; });
}

TopologySummary summarize(const std::vector<ComponentTopology>& components) {
  TopologySummary out;
  out.components = components.size();
  std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> kinds;
  for (const ComponentTopology& c : components) {
    out.euler_characteristic += c.euler_characteristic;
    out.genus += c.genus();
    out.boundary_loops += c.boundary_loops;
    ++kinds[{c.genus(), c.boundary_loops}];
  }
  for (const auto& [kind, count] : kinds) out.kinds.push_back({kind.first, kind.second, count});
  return out;
}

void transform_to(TriangleMesh& mesh, const Grid& grid, Space space) {
  if (space == Space::voxel) return;
  const double flip = space == Space::ras ? -1 : 1;
  for (Vec3& p : mesh.positions) {
    const Vec3 w = grid.to_world(p);
    p = {flip * w.x, flip * w.y, w.z};
  }
  if (grid.mirrored()) {
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  }
}

Extraction extract(const VolumeView& volume, const ExtractOptions& options, const RunControl& control) try {
  check_arguments(volume, options);
  const ThreadLimit threads(control.threads);
  Extraction out;
  ExtractReport& report = out.report;
  StageClock clock(report);
  // All work is done with the smallest spacing as unit of length, so that no length leaves the range of float.
  const Grid& grid = volume.grid;
  const double voxel = grid.smallest_spacing();
  VolumeView in_voxels = volume;
  in_voxels.grid.spacing = {grid.spacing.x / voxel, grid.spacing.y / voxel, grid.spacing.z / voxel};
  const auto voxels = [&](double world) { return static_cast<float>(std::min(world / voxel, 1e30)); };

  control.report("surface", 0);
  ParseOptions parse;
  parse.rule = {options.isovalue, options.inside, options.non_finite};
  parse.vertices_on_surface = options.vertices_on_surface;
  const SurfaceComplex surface = parse_surface(in_voxels, parse, control);
  if (surface.faces.empty()) throw_empty(volume, options);
  report.c_vertices = surface.positions.size();
  report.faces = surface.faces.size();
  report.double_segments = surface.double_segments;
  clock.finished("surface");

  control.report("components", 0);
  const Components reference = find_components(surface);
  report.reference = summarize(reference.topology);
  clock.finished("components");

  double longest = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3 s = in_voxels.grid.spacing;
    longest = std::max(longest, static_cast<double>(grid.size[a] - 1) * (a == 0 ? s.x : a == 1 ? s.y : s.z));
  }
  const double max_radius = options.max_radius ? std::max(1e-4f, voxels(*options.max_radius)) : longest / 2;

  control.report("coarsen", 0);
  const double block = std::min(kBlockVoxels, max_radius / kBlocksPerRadius);
  Coarsened coarser;
  if (block >= kLeastBlockVoxels) {
    coarser = coarsen(surface, block, control);
    report.coarsening = coarser.certificate;
    report.coarser_c_vertices.push_back(coarser.complex.positions.size());
  }
  const bool coarsened = !coarser.representative.empty();
  const SurfaceComplex& complex = coarsened ? coarser.complex : surface;
  clock.finished("coarsen");

  control.report("cover", 0);
  const CVertexGraph graph = make_graph(complex);
  CoveringOptions cover;
  cover.max_radius = static_cast<float>(max_radius);
  cover.event_persistence = options.event_persistence ? voxels(*options.event_persistence) : 1.5f;
  cover.first_stage = 4;
  Covering covering(graph, cover);
  covering.cover(control);
  clock.finished("cover");

  control.report("certify", 0);
  LevelReport& coarse = report.levels.emplace_back();
  CertifiedDual dual(complex, covering);
  dual.certify(coarse.certificate, control);
  clock.finished("certify");

  control.report("mesh", 0);
  const Partition& partition = covering.partition();
  TriangleMesh mesh;
  MeshTopology topology;
  for (int round = 0;; ++round) {
    mesh.triangles = to_triangles(dual.triangles());
    mesh.positions.clear();
    for (const CVertexId v : partition.site) mesh.positions.push_back(complex.positions[v]);
    topology = mesh_topology(mesh);
    const std::vector<std::uint8_t> turned =
        turned_components(mesh.positions, mesh.triangles, complex.spacing, topology.component_of_vertex, topology.components.size(),
                          outward_of_cells(complex, coarser, partition), 0);
    coarse.turned_components = static_cast<std::size_t>(std::count(turned.begin(), turned.end(), 1));
    if (coarse.turned_components == 0 || !refine_components(complex, covering, topology, turned, round, coarse.certificate)) break;
    dual.certify(coarse.certificate, control);
  }
  clock.finished("mesh");

  control.report("check", 0);
  std::vector<CVertexId> sites;  // on the surface itself
  sites.reserve(partition.site.size());
  for (const CVertexId v : partition.site) sites.push_back(coarsened ? coarser.representative[v] : v);
  finish_level(mesh, topology, sites, reference, grid, options.space, coarse);
  clock.finished("check");

  Hierarchy& hierarchy = out.hierarchy;
  hierarchy.positions = std::move(mesh.positions);
  hierarchy.levels.push_back({checked_id(hierarchy.positions.size(), "vertices"), std::move(mesh.triangles), {}});
  hierarchy.parent.resize(hierarchy.positions.size());
  std::iota(hierarchy.parent.begin(), hierarchy.parent.end(), 0u);
  if (options.refine.empty()) return out;

  control.report("refine", 0);
  Refiner refiner(surface, coarser, cover, covering);
  for (const LevelGoal& goal : options.refine) {
    const auto start = std::chrono::steady_clock::now();
    const RefinedLevel refined = refiner.refine(in_units_of(goal, voxel), options.placement, control);
    LevelReport& level = report.levels.emplace_back();
    level.certificate = refined.certificate;
    level.metrics = refined.metrics;
    level.constraints = refined.constraints;
    level.refine_rounds = refined.rounds;
    for (std::size_t m = 0; m < kMetricCount; ++m) {
      if (unit(static_cast<Quantity>(m)) != Unit::length) continue;
      level.metrics[m].maximum *= voxel;
      level.metrics[m].mean *= voxel;
    }
    for (std::size_t i = 0; i < goal.size(); ++i) {
      level.constraints[i].wanted = goal[i];
      if (unit(goal[i].quantity) == Unit::length) level.constraints[i].reached *= voxel;
    }

    const std::vector<CVertexId>& at = refiner.places().anchor;
    mesh.positions = positions_of(surface, at, refiner);
    mesh.triangles = refined.triangles;
    for (const auto& [cell, excess] : refined.at_limit)
      level.at_limit.push_back({to_space(mesh.positions[cell], grid, options.space), excess});
    topology = mesh_topology(mesh);
    const std::vector<Vec3> outward = area_vectors(surface, refiner.partition().cell_of, refiner.partition().cell_count());
    const std::vector<std::uint8_t> turned = turned_components(mesh.positions, mesh.triangles, surface.spacing,
                                                               topology.component_of_vertex, topology.components.size(), outward, 0);
    level.turned_components = static_cast<std::size_t>(std::count(turned.begin(), turned.end(), 1));
    finish_level(mesh, topology, refiner.partition().site, reference, grid, options.space, level);

    TriangleMesh on_surface;  // vertices that are new in this level; the others are there already
    for (std::size_t v = hierarchy.positions.size(); v < at.size(); ++v) on_surface.positions.push_back(surface.positions[at[v]]);
    transform_to(on_surface, grid, options.space);
    hierarchy.positions.insert(hierarchy.positions.end(), on_surface.positions.begin(), on_surface.positions.end());
    const std::vector<std::uint32_t> parents = refiner.parents();
    hierarchy.parent.insert(hierarchy.parent.end(), parents.begin() + static_cast<std::ptrdiff_t>(hierarchy.parent.size()), parents.end());
    const bool balanced = options.placement == Placement::balanced;
    hierarchy.levels.push_back(
        {checked_id(at.size(), "vertices"), std::move(mesh.triangles), balanced ? std::move(mesh.positions) : std::vector<Vec3>{}});
    level.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  clock.finished("refine");
  return out;
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory for this surface");
} catch (const std::length_error&) {
  throw Error(ErrorCode::out_of_memory, "this surface is too large for memory");
}

}  // namespace isoatlas
