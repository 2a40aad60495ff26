// SPDX-License-Identifier: Apache-2.0
#include "levels/level.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/ranges.h"
#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "field/to_space.h"
#include "geometry/mesh_nesting.h"
#include "geometry/triangle_pair.h"
#include "levels/mesh_figures.h"

namespace isoatlas::detail {
namespace {

// Checks that the topology counted on the output triangles equals that of the reference in every
// component. `component_of` is the reference component of each mesh vertex.
void check_mesh(const MeshTopology& mesh, const Components& reference,
                const std::vector<ComponentId>& component_of) {
  const auto fail = [](const std::string& what) {
    throw Error(ErrorCode::internal, "the finished mesh failed its check: " + what);
  };
  if (mesh.unused_vertices != 0)
    fail(std::to_string(mesh.unused_vertices) + " vertices without a triangle");
  if (!mesh.is_manifold())
    fail(std::to_string(mesh.non_manifold_edges) + " edges and " +
         std::to_string(mesh.non_manifold_vertices) + " vertices are not manifold, " +
         std::to_string(mesh.degenerate_triangles) + " triangles repeat a vertex");
  if (!mesh.is_oriented())
    fail(std::to_string(mesh.inconsistent_edges) +
         " edges between triangles of opposite orientation");
  if (mesh.components.size() != reference.topology.size())
    fail(std::to_string(mesh.components.size()) + " components instead of " +
         std::to_string(reference.topology.size()));
  std::vector<std::uint32_t> counterpart(reference.topology.size(), kNone);
  for (std::size_t v = 0; v < component_of.size(); ++v) {
    std::uint32_t& c = counterpart[component_of[v]];
    if (c == kNone) c = mesh.component_of_vertex[v];
    if (c != mesh.component_of_vertex[v])
      fail("vertex " + std::to_string(v) + " is connected to the wrong component");
  }
  for (std::size_t c = 0; c < counterpart.size(); ++c) {
    if (counterpart[c] == kNone) fail("component " + std::to_string(c) + " is missing");
    const ComponentTopology& expected = reference.topology[c];
    const ComponentTopology& found = mesh.components[counterpart[c]];
    if (expected == found) continue;
    fail("component " + std::to_string(c) + " has Euler characteristic " +
         std::to_string(found.euler_characteristic) + " and " +
         std::to_string(found.boundary_loops) + " boundary loops instead of " +
         std::to_string(expected.euler_characteristic) + " and " +
         std::to_string(expected.boundary_loops));
  }
}

// Number of components whose orientation or, if `nested`, nesting differs from that of the
// isosurface.
std::size_t count_misplaced(const MeshView& mesh, std::span<const ComponentId> component_of,
                            const AdaptiveSurface& surface, bool nested) {
  const std::vector<std::uint8_t> is_open = open_flags(surface.components());
  const Nesting& wanted = surface.nesting();
  if (nested) {
    const auto misplaced = differences(
        mesh_nesting(mesh.positions, mesh.triangles, component_of, is_open, surface.control()),
        wanted);
    return static_cast<std::size_t>(
        std::count(misplaced.begin(), misplaced.end(), std::uint8_t{1}));
  }
  const std::vector<std::int8_t> facing =
      mesh_facing(mesh.positions, mesh.triangles, component_of, is_open);
  std::size_t inverted = 0;
  for (std::size_t c = 0; c < facing.size(); ++c) inverted += facing[c] != wanted.facing[c] ? 1 : 0;
  return inverted;
}

// The area of the triangles from `first` on.
double area_of(const TriangleMesh& mesh, std::size_t first) {
  double sum = 0;
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3 p = mesh.positions[a];
    sum += length(cross(mesh.positions[b] - p, mesh.positions[c] - p)) / 2;
  }
  return sum;
}

// Appends the caps of a mesh in sample-index coordinates, and checks the topology of the closed
// mesh.
// @return its topology
MeshTopology append_caps(TriangleMesh& mesh, const std::vector<ComponentId>& component_of,
                         const AdaptiveSurface& surface, LevelReport& report,
                         const RunControl& control) {
  const CapReference& reference = *surface.caps();
  Caps caps =
      make_caps(mesh.positions, mesh.triangles, component_of, reference, surface.complex().spacing);
  if (!caps.faulty.empty())
    throw Error(ErrorCode::unsupported,
                "the surface cannot be closed on the volume boundary: its mesh would have to be "
                "finer around " +
                    std::to_string(caps.faulty.size()) +
                    " vertices, but self-intersections remain there; leave the border open");
  mesh.positions.insert(mesh.positions.end(), caps.corners.begin(), caps.corners.end());
  mesh.triangles.insert(mesh.triangles.end(), caps.triangles.begin(), caps.triangles.end());
  report.caps.emplace().triangles = caps.triangles.size();

  MeshTopology topology = mesh_topology(mesh, control);
  Components parts;
  parts.topology = reference.topology;
  std::vector<std::uint32_t> part_of;
  for (const ComponentId c : component_of) part_of.push_back(reference.part_of[c]);
  // A corner of the box belongs to the part of any vertex to which it is connected.
  std::vector<std::uint32_t> part_of_component(topology.components.size(), reference.whole_box);
  for (std::size_t v = 0; v < part_of.size(); ++v)
    part_of_component[topology.component_of_vertex[v]] = part_of[v];
  for (std::size_t v = part_of.size(); v < mesh.positions.size(); ++v)
    part_of.push_back(part_of_component[topology.component_of_vertex[v]]);
  check_mesh(topology, parts, part_of);
  report.topology = summarize(topology.components);
  return topology;
}

}  // namespace

void finish_level(TriangleMesh& mesh, const MeshTopology& topology,
                  std::span<const CVertexId> sites, const AdaptiveSurface& surface,
                  std::span<const ShapeObstacle> obstacles, const LevelGoal& goal, const Grid& grid,
                  const ExtractOptions& options, LevelReport& report, const RunControl& control) {
  const Components& reference = surface.components();
  std::vector<ComponentId> component_of;
  component_of.reserve(sites.size());
  for (const CVertexId v : sites) component_of.push_back(reference.of_c_vertex[v]);
  check_mesh(topology, reference, component_of);
  report_continuing(control);
  report.topology = summarize(topology.components);
  const std::size_t open_triangles = mesh.triangles.size();
  std::optional<MeshTopology> closed_topology;
  if (surface.caps() != nullptr)
    closed_topology = append_caps(mesh, component_of, surface, report, control);
  report.vertices = mesh.positions.size();
  report.triangles = mesh.triangles.size();

  const Space space = options.space;
  for (Vec3& p : mesh.positions) p = to_volume(p, options);
  // Shape is measured in world lengths, whatever the output space is.
  TriangleMesh world = space == Space::voxel ? mesh : TriangleMesh{};
  TriangleMesh& measured = space == Space::voxel ? world : mesh;
  transform_to(measured, grid, space == Space::voxel ? Space::lps : space);
  const auto without_caps = [&](const TriangleMesh& all) {
    return MeshView(std::span(all.positions).first(sites.size()),
                    std::span(all.triangles).first(open_triangles));
  };
  if (report.caps) report.caps->area = area_of(measured, open_triangles);
  RunControl quiet = control;  // runs in parallel with other checks, so it must not report progress
  quiet.progress = nullptr;
  run_both(
      [&] {
        if (!options.allow_self_intersections) fill_self_intersections(mesh, report, quiet);
        quiet.check_cancelled();
        report.bad_triangles =
            bad_triangles(without_caps(measured), without_caps(mesh), obstacles, goal);
      },
      [&] {
        report.extent = summarize(
            extents_of(measured, mesh, closed_topology ? *closed_topology : topology, quiet));
        report.quality = mesh_quality(without_caps(measured), quiet);
        report.quality.zero_area_triangles = static_cast<std::size_t>(ranges::count_if(
            mesh.triangles, [&](const Triangle& t) { return !has_area(mesh.positions, t); }));
        quiet.check_cancelled();
        report.inverted_components = count_misplaced(without_caps(mesh), component_of, surface,
                                                     !options.allow_self_intersections);
      });
  report_continuing(control);
}

}  // namespace isoatlas::detail

namespace isoatlas {

bool LevelReport::all_satisfied() const {
  return std::all_of(constraints.begin(), constraints.end(), [](const ConstraintResult& c) {
    return c.satisfied || c.constraint.is_default;
  });
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

}  // namespace isoatlas

namespace isoatlas::detail {

void to_output_space(TriangleMesh& mesh, const Grid& grid, const ExtractOptions& options) {
  for (Vec3& p : mesh.positions) p = to_volume(p, options);
  transform_to(mesh, grid, options.space);
}

}  // namespace isoatlas::detail
