// SPDX-License-Identifier: Apache-2.0
// isoatlas check: checks the topology, shape and distance of a mesh.
#include <algorithm>
#include <iostream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "core/file_name.h"
#include "exit_status.h"
#include "extent_text.h"
#include "isoatlas/component_extents.h"
#include "isoatlas/error.h"
#include "isoatlas/extract.h"
#include "isoatlas/io.h"
#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "mesh_place.h"
#include "progress_bar.h"
#include "report/report.h"
#include "text.h"
#include "volume_input.h"

namespace isoatlas::detail::tool {
namespace {

/// "yes", or "no: " and the faults that occur, with their counts.
std::string verdict(std::initializer_list<std::pair<std::size_t, const char*>> faults) {
  std::string text;
  for (const auto& [count, fault] : faults)
    if (count > 0) text += (text.empty() ? "no: " : "; ") + count_text(count) + " " + fault;
  return text.empty() ? "yes" : text;
}

void print_topology(const MeshTopology& topology) {
  std::cout << row("vertices",
                   count_text(topology.vertices) +
                       (topology.unused_vertices > 0
                            ? " (" + count_text(topology.unused_vertices) + " in no triangle)"
                            : ""))
            << row("edges", count_text(topology.edges))
            << row("triangles", count_text(topology.triangles))
            << row("manifold",
                   verdict({{topology.non_manifold_edges, "edges in three or more triangles"},
                            {topology.non_manifold_vertices,
                             "vertices with more than one fan of triangles"},
                            {topology.degenerate_triangles, "triangles that use a vertex twice"}}))
            << row("oriented", verdict({{topology.inconsistent_edges,
                                         "edges whose two triangles face opposite sides"}}))
            << row("closed", verdict({{topology.boundary_edges, "boundary edges"}}));
  if (topology.is_manifold() && topology.is_oriented()) {
    const TopologySummary summary = summarize(topology.components);
    std::cout << row("topology", topology_text(summary)) << row("kinds", kinds_text(summary, 6));
  } else {
    std::cout << row("topology",
                     counted(topology.components.size(), "component") + "; genus is not defined");
  }
}

void print_quality(const MeshQuality& quality, bool utf8) {
  std::cout << row("aspect ratio",
                   "minimum " + ratio_text(quality.aspect_min) + ", 1st percentile " +
                       ratio_text(quality.aspect_p01) + ", median " +
                       ratio_text(quality.aspect_median) +
                       "; below 1/3: " + percent_text(quality.aspect_share_below_third));
  for (const std::string& line :
       draw_histogram(quality.aspect_histogram, 5, 2, Scale::linear, utf8))
    std::cout << row("", line);
  std::cout << row("", "0                 0.5                  1")
            << row("angles", number_text(quality.angle_min) + " to " +
                                 number_text(quality.angle_max) + " degrees")
            << row("between triangles", number_text(quality.dihedral_min) + " to " +
                                            number_text(quality.dihedral_max) + " degrees")
            << row("edge lengths",
                   number_text(quality.edge_min) + " to " + number_text(quality.edge_max))
            << row("zero area", counted(quality.zero_area_triangles, "triangle"));
}

SelfIntersectionReport find_self_intersections(const CheckArguments& arguments,
                                               const TriangleMesh& mesh,
                                               const RunControl& control) {
  try {
    return isoatlas::detail::find_self_intersections(mesh, control);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    throw error.with_prefix(arguments.mesh.string() + ": ");
  }
}

void print_self_intersections(const SelfIntersectionReport& report) {
  std::cout << row("intersections",
                   report.pairs == 0 ? "none" : counted(report.pairs, "pair") + " of triangles");
  for (const auto& [pair, at] : report.first)
    std::cout << row("", "triangles " + std::to_string(pair.first) + " and " +
                             std::to_string(pair.second) + " near " + point_text(at));
  if (report.pairs > report.first.size())
    std::cout << row("", "and " + counted(report.pairs - report.first.size(), "more pair"));
}

/// The space that the user states, else that of the file, else lps.
Space space_of(const CheckArguments& arguments) {
  if (arguments.space) return *arguments.space;
  const std::string stated = lower_case(mesh_space(arguments.mesh));
  return stated == "ras" ? Space::ras : stated == "voxel" ? Space::voxel : Space::lps;
}

struct MeasuredDistance {
  DistanceReport report;
  LengthUnit unit = LengthUnit::unknown;  // of lengths and positions: the unit of the volume
  std::string misplacement;
};

MeasuredDistance measure_distance(const CheckArguments& arguments, TriangleMesh mesh,
                                  const RunControl& control) {
  DistanceReport report;
  report.volume_path = arguments.volume->string();
  report.options = arguments.measure;
  report.options.space = space_of(arguments);
  const VolumeFile file = read_volume_input(*arguments.volume, arguments.read);
  print_warnings(std::cerr, *arguments.volume, file.source);
  const Volume& volume = file.volume;
  // Sample indices have no unit, even if the file states one.
  if (report.options.space != Space::voxel)
    convert_unit(mesh, mesh_file_info(arguments.mesh).unit, volume.view.grid.unit);
  try {
    report.measured = measure(mesh, volume, report.options, control);
  } catch (const Error& error) {
    // The library does not know the name of the volume.
    throw error.with_prefix(volume_name(report.volume_path) + ": ");
  }
  std::string misplaced =
      misplacement(mesh, volume.view.grid, report.options.space, report.measured);
  const bool has_unit = report.options.space != Space::voxel;
  return {std::move(report), has_unit ? volume.view.grid.unit : LengthUnit::unknown,
          std::move(misplaced)};
}

std::string length_text(double length, double voxel) {
  return number_text(length) + " (" + ratio_text(length / voxel) + " vx)";
}

std::string one_side_text(const OneSidedDistance& d, double voxel) {
  return "mean " + length_text(d.mean, voxel) + ", 99 % within " + length_text(d.p99, voxel) +
         ", maximum " + length_text(d.maximum, voxel) + " at " + point_text(d.farthest);
}

std::string samples_text(const OneSidedDistance& d, std::size_t spread, const char* where) {
  return counted(d.samples, "sample") + ": " + count_text(spread) + " spread evenly, " +
         ratio_text(d.samples_per_voxel_face) + " per square voxel, and at " + where;
}

void print_distance(const DistanceReport& report, LengthUnit unit) {
  const Measurement& m = report.measured;
  const Space space = report.options.space;
  const std::size_t spread = report.options.samples;
  const std::string name = report.options.surface.interpolation == Interpolation::tricubic
                               ? "tricubic isosurface"
                               : "isosurface";
  std::cout << row("distance",
                   "to the " + name + " at " + number_text(report.options.surface.isovalue) +
                       " of " + report.volume_path + ", mesh in " +
                       (space == Space::lps   ? "LPS"
                        : space == Space::ras ? "RAS"
                                              : "voxels") +
                       ", 1 vx = " + with_unit(m.voxel, unit) +
                       (unit == LengthUnit::unknown
                            ? ""
                            : "; all lengths and positions in " + std::string(symbol(unit))))
            << row("  to surface", one_side_text(m.mesh_to_surface, m.voxel))
            << row("", samples_text(m.mesh_to_surface, spread,
                                    "vertices, edge midpoints and centroids of the mesh"))
            << row("  to mesh", one_side_text(m.surface_to_mesh, m.voxel))
            << row("", samples_text(m.surface_to_mesh, spread, "c-vertices of the surface"))
            << row("  normals",
                   "off by " + number_text(m.normal_mean) + " degrees on average, 99 % within " +
                       number_text(m.normal_p99) + ", maximum " + number_text(m.normal_maximum))
            << row("  area",
                   "mesh " + number_text(m.mesh_area) + ", surface " + number_text(m.surface_area));
}

}  // namespace

int run_check(const CheckArguments& arguments, Interruption& interruption) {
  ProgressBar progress(arguments.volume.has_value() || arguments.self_intersections);
  const Interruption::Cleanup clean_up(interruption, [&] { progress.erase(); });
  RunControl control;
  control.progress = [&](std::string_view stage, double fraction) {
    progress.show(stage, fraction);
  };
  control.cancel = &interruption.requested();

  const TriangleMesh mesh = read_mesh(arguments.mesh);
  const MeshTopology topology = mesh_topology(mesh);
  const MeshExtent extent = summarize(component_extents(mesh, topology), kCheckedComponents);
  const MeshQuality quality = mesh_quality(mesh);
  std::optional<SelfIntersectionReport> intersections;
  if (arguments.self_intersections)
    intersections = find_self_intersections(arguments, mesh, control);
  std::optional<MeasuredDistance> distance;
  if (arguments.volume) distance = measure_distance(arguments, mesh, control);
  progress.erase();
  if (arguments.json) {
    std::cout << to_json(arguments.mesh.string(), topology, extent, quality,
                         intersections ? &*intersections : nullptr,
                         distance ? &distance->report : nullptr);
  } else {
    std::cout << one_line(arguments.mesh.string()) << "\n";
    print_topology(topology);
    const LengthUnit unit = mesh_file_info(arguments.mesh).unit;
    print_extent(std::cout, extent, unit, std::string(symbol(unit)));
    if (topology.triangles > 0) print_quality(quality, terminal_is_utf8());
    if (intersections) print_self_intersections(*intersections);
    if (distance) print_distance(distance->report, distance->unit);
  }
  const bool is_misplaced = distance && !distance->misplacement.empty();
  if (is_misplaced)
    std::cerr << one_line("isoatlas: " + arguments.mesh.string() + ": " + distance->misplacement)
              << "\n";
  const bool is_self_intersecting = intersections && intersections->pairs > 0;
  // A mesh without triangles violates no rule, but it fails the check.
  return topology.is_manifold() && topology.is_oriented() && topology.triangles > 0 &&
                 !is_self_intersecting && !is_misplaced
             ? kSuccess
             : kCheckFailed;
}

}  // namespace isoatlas::detail::tool
