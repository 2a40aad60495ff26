// SPDX-License-Identifier: Apache-2.0
// isoatlas check: is this mesh what a mesh should be?
#include <iostream>
#include <string>
#include <utility>

#include "commands.h"
#include "exit_status.h"
#include "isoatlas/extract.h"
#include "isoatlas/io.h"
#include "isoatlas/mesh.h"
#include "report/report.h"
#include "text.h"

namespace isoatlas::tool {
namespace {

/// "yes", or "no: " and those of the faults that occur.
std::string verdict(std::initializer_list<std::pair<std::size_t, const char*>> faults) {
  std::string text;
  for (const auto& [count, fault] : faults)
    if (count > 0) text += (text.empty() ? "no: " : "; ") + count_text(count) + " " + fault;
  return text.empty() ? "yes" : text;
}

void print_topology(const MeshTopology& topology) {
  std::cout << row("vertices", count_text(topology.vertices) +
                                   (topology.unused_vertices > 0 ? " (" + count_text(topology.unused_vertices) + " in no triangle)" : ""))
            << row("edges", count_text(topology.edges)) << row("triangles", count_text(topology.triangles))
            << row("manifold", verdict({{topology.non_manifold_edges, "edges in three or more triangles"},
                                        {topology.non_manifold_vertices, "vertices with more than one fan of triangles"},
                                        {topology.degenerate_triangles, "triangles that use a vertex twice"}}))
            << row("oriented", verdict({{topology.inconsistent_edges, "edges whose two triangles face opposite sides"}}))
            << row("closed", verdict({{topology.boundary_edges, "boundary edges"}}));
  if (topology.is_manifold() && topology.is_oriented()) {
    const TopologySummary summary = summarize(topology.components);
    std::cout << row("topology", topology_text(summary)) << row("kinds", kinds_text(summary, 6));
  } else {
    std::cout << row("topology", counted(topology.components.size(), "component") + "; genus is not defined");
  }
}

void print_quality(const MeshQuality& quality, bool utf8) {
  std::cout << row("aspect ratio", "minimum " + ratio_text(quality.aspect_min) + ", 1st percentile " + ratio_text(quality.aspect_p01) +
                                       ", median " + ratio_text(quality.aspect_median) +
                                       "; below 1/3: " + percent_text(quality.aspect_share_below_third));
  for (const std::string& line : draw_histogram(quality.aspect_histogram, 5, 2, Scale::linear, utf8)) std::cout << row("", line);
  std::cout << row("", "0                 0.5                  1")
            << row("angles", number_text(quality.angle_min) + " to " + number_text(quality.angle_max) + " degrees")
            << row("edge lengths", number_text(quality.edge_min) + " to " + number_text(quality.edge_max))
            << row("zero area", counted(quality.zero_area_triangles, "triangle"));
}

}  // namespace

int run_check(const CheckArguments& arguments) {
  const TriangleMesh mesh = read_mesh(arguments.mesh);
  const MeshTopology topology = mesh_topology(mesh);
  const MeshQuality quality = mesh_quality(mesh);
  if (arguments.json) {
    std::cout << to_json(arguments.mesh.string(), topology, quality);
  } else {
    std::cout << one_line(arguments.mesh.string()) << "\n";
    print_topology(topology);
    if (topology.triangles > 0) print_quality(quality, terminal_is_utf8());
  }
  // No triangles break no rule, but nobody who asks for a check means that by a good mesh.
  return topology.is_manifold() && topology.is_oriented() && topology.triangles > 0 ? kSuccess : kCheckFailed;
}

}  // namespace isoatlas::tool
