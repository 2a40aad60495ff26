// SPDX-License-Identifier: Apache-2.0
// The place to start reading: volume -> surface complex -> coarser complex -> covering -> certified dual -> checked mesh.
#include "isoatlas/extract.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <new>

#include "core/parallel.h"
#include "core/vector_math.h"
#include "cover/repair.h"
#include "mesh/outward.h"
#include "partition/coarsen.h"
#include "surface/components.h"
#include "surface/parse_surface.h"
#include "volume/gradient.h"

namespace isoatlas {
namespace {

// The coarser complex: blocks of four voxels, but well below the largest radius, so that its c-vertices leave the covering a
// choice; below one and a half voxels blocks gain nothing and the covering works on the full complex.
constexpr double kBlockVoxels = 4;
constexpr double kBlocksPerRadius = 4;
constexpr double kLeastBlockVoxels = 1.5;

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

void check_arguments(const VolumeView& volume, const ExtractOptions& options) {
  const Grid& grid = volume.grid;
  for (int a = 0; a < 3; ++a) {
    require(grid.size[a] >= 2,
            std::string("the volume has ") + std::to_string(grid.size[a]) + " samples along " + "xyz"[a] + "; at least 2 are needed");
  }
  for (const double s : {grid.spacing.x, grid.spacing.y, grid.spacing.z}) {
    require(std::isfinite(s) && s > 0, "spacing " + std::to_string(s) + " is not a positive length");
  }
  require(std::isfinite(options.isovalue), "the isovalue is not a finite number");
  require(!options.max_radius || (std::isfinite(*options.max_radius) && *options.max_radius > 0),
          "the largest radius must be a positive length");
  require(!options.event_persistence || (std::isfinite(*options.event_persistence) && *options.event_persistence >= 0),
          "the event persistence must be a length >= 0");
}

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", x);
  return text;
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

// Gives every marked component one more site, where it is farthest from the others. @return false if none had room for one
bool refine_components(const SurfaceComplex& complex, Covering& covering, const MeshTopology& topology,
                       const std::vector<std::uint8_t>& marked, ExtractReport& report) {
  const Partition& partition = covering.partition();
  const std::uint32_t before = covering.site_count();
  std::vector<CVertexId> farthest(topology.components.size(), kNone);
  for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
    const std::uint32_t component = topology.component_of_vertex[partition.cell_of[v]];
    if (!marked[component] || covering.distance()[v] == 0) continue;
    CVertexId& best = farthest[component];
    if (best == kNone || covering.distance()[v] > covering.distance()[best]) best = v;
  }
  for (const CVertexId v : farthest) {
    if (v == kNone) continue;
    covering.lower_radius(v, covering.distance()[v]);
    covering.insert(v);
  }
  report.certificate.repair_sites += covering.site_count() - before;
  return covering.site_count() > before;
}

TriangleMesh to_mesh(const SurfaceComplex& complex) {
  TriangleMesh mesh;
  mesh.positions = complex.positions;
  mesh.triangles.reserve(complex.faces.size());
  for (const Face& f : complex.faces) mesh.triangles.push_back({f.corner[0], f.corner[1], f.corner[2]});
  return mesh;
}

}  // namespace

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
  const double voxel = volume.grid.smallest_spacing();

  control.report("surface", 0);
  ParseOptions parse;
  parse.rule = {options.isovalue, options.inside, options.non_finite};
  parse.vertices_on_surface = options.vertices_on_surface;
  const SurfaceComplex surface = parse_surface(volume, parse, control);
  if (surface.faces.empty()) throw_empty(volume, options);
  report.c_vertices = surface.positions.size();
  report.faces = surface.faces.size();
  report.double_segments = surface.double_segments;
  clock.finished("surface");

  control.report("components", 0);
  const Components reference = find_components(surface);
  report.reference = summarize(reference.topology);
  clock.finished("components");

  const Grid& grid = volume.grid;
  const double longest =
      std::max({static_cast<double>(grid.size[0] - 1) * grid.spacing.x, static_cast<double>(grid.size[1] - 1) * grid.spacing.y,
                static_cast<double>(grid.size[2] - 1) * grid.spacing.z});
  const double max_radius = options.max_radius.value_or(longest / 2);

  control.report("coarsen", 0);
  const double block = std::min(kBlockVoxels * voxel, max_radius / kBlocksPerRadius);
  Coarsened coarser;
  if (block >= kLeastBlockVoxels * voxel) {
    coarser = coarsen(surface, block, control);
    report.coarsening = coarser.certificate;
    report.coarsening_rounds = coarser.certificate.repair_rounds;
    report.coarser_c_vertices.push_back(coarser.complex.positions.size());
  }
  const bool coarsened = !coarser.representative.empty();
  const SurfaceComplex& complex = coarsened ? coarser.complex : surface;
  clock.finished("coarsen");

  control.report("cover", 0);
  const CVertexGraph graph = make_graph(complex);
  CoveringOptions cover;
  cover.max_radius = static_cast<float>(max_radius);
  cover.event_persistence = static_cast<float>(options.event_persistence.value_or(1.5 * voxel));
  cover.first_stage = static_cast<float>(4 * voxel);
  Covering covering(graph, cover);
  covering.cover(control);
  clock.finished("cover");

  control.report("certify", 0);
  PartitionCheck check = certify_and_repair(complex, covering, report.certificate, control);
  clock.finished("certify");

  control.report("mesh", 0);
  MeshTopology topology;
  for (;;) {
    out.mesh = to_mesh(dual_complex(complex, covering.partition(), check.triangles));
    topology = mesh_topology(out.mesh);
    const std::vector<std::uint8_t> turned =
        turned_components(out.mesh.positions, out.mesh.triangles, grid.spacing, topology.component_of_vertex, topology.components.size(),
                          outward_directions(volume, parse.rule, out.mesh.positions), 0);
    report.turned_components = static_cast<std::size_t>(std::count(turned.begin(), turned.end(), 1));
    if (report.turned_components == 0 || !refine_components(complex, covering, topology, turned, report)) break;
    check = certify_and_repair(complex, covering, report.certificate, control);
  }
  clock.finished("mesh");

  control.report("check", 0);
  std::vector<ComponentId> component_of;
  component_of.reserve(out.mesh.positions.size());
  for (const CVertexId v : covering.partition().site)
    component_of.push_back(reference.of_c_vertex[coarsened ? coarser.representative[v] : v]);
  check_mesh(topology, reference, component_of);
  report.mesh = summarize(topology.components);
  clock.finished("check");

  // Shape is a matter of world lengths, whatever the space of the output.
  TriangleMesh world = options.space == Space::voxel ? out.mesh : TriangleMesh{};
  TriangleMesh& measured = options.space == Space::voxel ? world : out.mesh;
  transform_to(measured, grid, options.space == Space::voxel ? Space::lps : options.space);
  report.quality = mesh_quality(measured);
  return out;
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory for this surface");
}

}  // namespace isoatlas
