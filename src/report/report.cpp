// SPDX-License-Identifier: Apache-2.0
#include "report/report.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "isoatlas/version.h"

namespace isoatlas {
namespace {

using Json = nlohmann::ordered_json;  // keys stay in the order in which they are written here

std::string_view text(Inside inside) { return inside == Inside::above ? "above" : "below"; }

std::string_view text(NonFinite rule) {
  switch (rule) {
    case NonFinite::refuse:
      return "refuse";
    case NonFinite::below:
      return "below";
    case NonFinite::above:
      return "above";
  }
  return "";
}

std::string_view text(Space space) {
  switch (space) {
    case Space::lps:
      return "lps";
    case Space::ras:
      return "ras";
    case Space::voxel:
      return "voxel";
  }
  return "";
}

Json to_value(Vec3 v) { return Json::array({v.x, v.y, v.z}); }

Json to_value(const std::optional<double>& length) { return length ? Json(*length) : Json(); }

void add_topology(Json& object, const TopologySummary& topology) {
  object["components"] = topology.components;
  object["euler_characteristic"] = topology.euler_characteristic;
  object["genus"] = topology.genus;
  object["boundary_loops"] = topology.boundary_loops;
  Json kinds = Json::array();
  for (const TopologySummary::Kind& kind : topology.kinds)
    kinds.push_back({{"genus", kind.genus}, {"boundary_loops", kind.boundary_loops}, {"count", kind.count}});
  object["kinds"] = std::move(kinds);
}

Json to_value(const CertificateReport& certificate) {
  return {{"passed", certificate.passed},
          {"cells_checked", certificate.cells_checked},
          {"arcs_checked", certificate.arcs_checked},
          {"triples_checked", certificate.triples_checked},
          {"repair_rounds", certificate.repair_rounds},
          {"repair_sites", certificate.repair_sites}};
}

Json to_value(const MeshQuality& quality) {
  return {{"aspect_ratio",
           {{"minimum", quality.aspect_min},
            {"p01", quality.aspect_p01},
            {"median", quality.aspect_median},
            {"share_below_third", quality.aspect_share_below_third},
            {"histogram", quality.aspect_histogram}}},
          {"angle_degrees", {{"minimum", quality.angle_min}, {"maximum", quality.angle_max}}},
          {"edge_length", {{"minimum", quality.edge_min}, {"maximum", quality.edge_max}}},
          {"zero_area_triangles", quality.zero_area_triangles}};
}

Json lengths(const OneSidedDistance& distance, double unit) {
  return {{"maximum", distance.maximum / unit},
          {"mean", distance.mean / unit},
          {"root_mean_square", distance.root_mean_square / unit},
          {"p50", distance.p50 / unit},
          {"p99", distance.p99 / unit}};
}

Json one_side(const OneSidedDistance& distance, double voxel) {
  return {{"samples", distance.samples},
          {"samples_per_voxel_face", distance.samples_per_voxel_face},
          {"world", lengths(distance, 1)},
          {"voxels", lengths(distance, voxel)},
          {"farthest", to_value(distance.farthest)}};
}

Json to_value(const Measurement& measurement) {
  return {{"voxel", measurement.voxel},
          {"maximum", measurement.maximum()},
          {"p99", measurement.p99()},
          {"mean", measurement.mean()},
          {"mesh_to_surface", one_side(measurement.mesh_to_surface, measurement.voxel)},
          {"surface_to_mesh", one_side(measurement.surface_to_mesh, measurement.voxel)},
          {"normal_degrees", {{"mean", measurement.normal_mean}, {"p99", measurement.normal_p99}, {"maximum", measurement.normal_maximum}}},
          {"surface_area", measurement.surface_area},
          {"mesh_area", measurement.mesh_area}};
}

Json to_value(const DistanceReport& distance) {
  const MeasureOptions& options = distance.options;
  Json json = {{"volume", distance.volume_path},         {"isovalue", options.isovalue}, {"inside", text(options.inside)},
               {"non_finite", text(options.non_finite)}, {"space", text(options.space)}, {"samples_wanted", options.samples}};
  json.update(to_value(distance.measured));
  return json;
}

/// For people too: one line per key, lists of numbers on that line, lists of objects with one object per line.
void print(const Json& value, std::string& text, const std::string& indent = "\n") {
  const bool is_list = value.is_array() && !value.empty() && value[0].is_object();
  if (!is_list && !value.is_object()) {
    // A path may hold bytes that are not UTF-8; a report with a replacement character beats no report.
    text += value.dump(-1, ' ', false, Json::error_handler_t::replace);
    return;
  }
  text += is_list ? '[' : '{';
  bool first = true;
  for (const auto& [key, item] : value.items()) {
    if (!first) text += ',';
    first = false;
    text += indent + "  ";
    if (is_list) {
      text += item.dump();
    } else {
      text += Json(key).dump() + ": ";
      print(item, text, indent + "  ");
    }
  }
  text += indent;
  text += is_list ? ']' : '}';
}

std::string to_text(const Json& json) {
  std::string text;
  print(json, text);
  return text + "\n";
}

}  // namespace

std::string to_json(const ExtractReport& report, const ReportContext& context) {
  const ExtractOptions& options = context.options;
  Json json;
  json["schema"] = "isoatlas-report-1";
  json["version"] = ISOATLAS_VERSION;
  json["input"] = {{"path", context.volume_path},
                   {"sample_type", name(context.sample_type)},
                   {"size", context.grid.size},
                   {"spacing", to_value(context.grid.spacing)},
                   {"origin", to_value(context.grid.origin)},
                   {"direction", Json::array({to_value(context.grid.direction[0]), to_value(context.grid.direction[1]),
                                              to_value(context.grid.direction[2])})}};
  json["surface"] = {{"isovalue", options.isovalue},
                     {"inside", text(options.inside)},
                     {"tie_rule", "a sample equal to the isovalue is inside"},
                     {"ambiguous_faces", "asymptotic decider"},
                     {"topology", "faces"}};
  json["parameters"] = {{"non_finite", text(options.non_finite)},
                        {"space", text(options.space)},
                        {"max_radius", to_value(options.max_radius)},
                        {"event_persistence", to_value(options.event_persistence)},
                        {"vertices_on_surface", options.vertices_on_surface},
                        {"threads", context.threads}};

  Json& reference =
      json["reference"] = {{"c_vertices", report.c_vertices}, {"faces", report.faces}, {"double_segments", report.double_segments}};
  add_topology(reference, report.reference);
  const LevelReport& finest = report.levels.back();
  Json& mesh = json["mesh"] = {{"path", context.mesh_path}, {"vertices", finest.vertices}, {"triangles", finest.triangles}};
  add_topology(mesh, finest.topology);
  mesh["turned_components"] = finest.turned_components;
  json["certificate"] = to_value(finest.certificate);
  json["coarsening"] = {{"rounds", report.coarsening.repair_rounds},
                        {"c_vertices", report.coarser_c_vertices},
                        {"certificate", report.coarser_c_vertices.empty() ? Json() : to_value(report.coarsening)}};
  json["quality"] = to_value(finest.quality);

  Json& seconds = json["seconds"] = {{"read", context.read_seconds}};
  for (const StageTime& stage : report.seconds) seconds[stage.stage] = stage.seconds;
  seconds["write"] = context.write_seconds;
  seconds["total"] = report.total_seconds;
  json["peak_memory_bytes"] = context.peak_memory_bytes;
  return to_text(json);
}

std::string to_json(const std::string& mesh_path, const MeshTopology& topology, const MeshQuality& quality,
                    const DistanceReport* distance) {
  Json json;
  json["schema"] = "isoatlas-check-1";
  json["version"] = ISOATLAS_VERSION;
  json["path"] = mesh_path;
  json["manifold"] = topology.is_manifold();
  json["oriented"] = topology.is_oriented();
  json["closed"] = topology.boundary_edges == 0;
  json["vertices"] = topology.vertices;
  json["edges"] = topology.edges;
  json["triangles"] = topology.triangles;
  json["unused_vertices"] = topology.unused_vertices;
  json["degenerate_triangles"] = topology.degenerate_triangles;
  json["non_manifold_edges"] = topology.non_manifold_edges;
  json["non_manifold_vertices"] = topology.non_manifold_vertices;
  json["inconsistent_edges"] = topology.inconsistent_edges;
  json["boundary_edges"] = topology.boundary_edges;
  if (topology.is_manifold() && topology.is_oriented()) {
    add_topology(json, summarize(topology.components));
  } else {
    json["components"] = topology.components.size();
    for (const char* key : {"euler_characteristic", "genus", "boundary_loops", "kinds"}) json[key] = nullptr;
  }
  json["quality"] = to_value(quality);
  json["distance"] = distance ? to_value(*distance) : Json();
  return to_text(json);
}

}  // namespace isoatlas
