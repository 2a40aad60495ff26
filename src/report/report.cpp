// SPDX-License-Identifier: Apache-2.0
#include "report/report.h"

#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <new>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "api/resolve_options.h"
#include "isoatlas/error.h"
#include "isoatlas/json.h"
#include "isoatlas/version.h"
#include "report/json_values.h"

namespace isoatlas::detail {

using report::add_topology;
using report::Json;
using report::to_text;

namespace {

using report::to_value;

constexpr std::string_view kReportSchema = "isoatlas-report-3";

std::string_view text(Inside inside) { return inside == Inside::above ? "above" : "below"; }

std::string_view text(Topology topology) {
  return topology == Topology::faces ? "faces" : "trilinear";
}
std::string_view text(Interpolation interpolation) {
  return interpolation == Interpolation::trilinear ? "trilinear" : "tricubic";
}

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

std::string_view text(CoveringStrategy strategy) {
  return strategy == CoveringStrategy::sizing_field ? "sizing-field" : "halving";
}

std::string_view text(Placement placement) {
  return placement == Placement::surface ? "surface" : "balanced";
}

std::string_view text(Border border) { return border == Border::open ? "open" : "closed"; }

Json length_value(const std::optional<Length>& length) {
  return length ? Json(length->value) : Json();
}

Json points_value(const std::vector<Vec3>& points) {
  Json out = Json::array();
  for (const Vec3& point : points) out.push_back(to_value(point));
  return out;
}

Json path_value(const std::string& path) { return path.empty() ? Json() : Json(path); }

/// The constraints of each refined level.
Json goals_value(const ExtractOptions& options, const ExtractReport& report) {
  Json list = Json::array();
  if (options.levels == 0) {
    for (const LevelGoal& goal : options.refine) list.push_back(to_value(goal));
    return list;
  }
  for (const LevelReport& level : report.levels) {  // planned by extract()
    LevelGoal goal;
    for (const ConstraintResult& result : level.constraints) goal.push_back(result.constraint);
    list.push_back(to_value(goal));
  }
  return list;
}

Json to_value(const SelfIntersectionReport& self_intersections) {
  Json first = Json::array();
  for (const SelfIntersectionReport::Place& place : self_intersections.first)
    first.push_back({{"triangles", {place.triangles.first, place.triangles.second}},
                     {"position", to_value(place.position)}});
  return {{"pairs", self_intersections.pairs}, {"first", first}};
}

Json to_value(const ReportFile& file) {
  Json self_intersections = Json::array();
  for (const SelfIntersectionReport& level : file.self_intersections)
    self_intersections.push_back(to_value(level));
  return {{"path", file.path},
          {"levels", file.levels},
          {"bytes", file.bytes},
          {"positions", file.single_precision ? "float32" : "float64"},
          {"largest_rounding", file.largest_rounding},
          {"space", file.space},
          {"unit", file.unit == LengthUnit::unknown ? Json() : Json(symbol(file.unit))},
          {"notes", file.notes},
          {"self_intersections", file.self_intersections.empty() ? Json() : self_intersections}};
}

Json to_value(const DistanceReport& distance) {
  const MeasureOptions& options = distance.options;
  Json json = {{"volume", path_value(distance.volume_path)},
               {"isovalue", options.surface.isovalue},
               {"inside", text(options.surface.inside)},
               {"topology", text(options.surface.topology)},
               {"non_finite", text(options.surface.non_finite)},
               {"interpolation", text(options.surface.interpolation)},
               {"space", text(options.space)},
               {"samples_wanted", options.samples}};
  json.update(to_value(distance.measured));
  return json;
}

Json to_value(const BlockSummary& blocks) {
  return {{"size", blocks.block_size},           {"counts", blocks.counts},
          {"with_surface", blocks.with_surface}, {"seam_vertices", blocks.seam_vertices},
          {"seam_edges", blocks.seam_edges},     {"removed_vertices", blocks.removed_vertices}};
}

Json to_value(const RankedComponent& component) {
  return {{"position", to_value(component.position)},
          {"part", component.part},
          {"size", component.size},
          {"c_vertices", component.c_vertices},
          {"genus", component.topology.genus()},
          {"boundary_loops", component.topology.boundary_loops}};
}

Json to_value(const VolumeReport& volume) {
  const Grid& grid = volume.grid;
  Json json;
  json["path"] = path_value(volume.path);
  json["sample_type"] = name(volume.sample_type);
  json["size"] = grid.size;
  json["spacing"] = to_value(grid.spacing);
  json["origin"] = to_value(grid.origin);
  json["direction"] = Json::array(
      {to_value(grid.direction[0]), to_value(grid.direction[1]), to_value(grid.direction[2])});
  json["unit"] = grid.unit == LengthUnit::unknown ? Json() : Json(symbol(grid.unit));
  json["format"] = volume.source.format.empty() ? Json() : Json(volume.source.format);
  json["reader"] = volume.source.reader.empty() ? Json() : Json(volume.source.reader);
  Json& decisions = json["decisions"] = Json::array();
  for (const ReadDecision& decision : volume.source.decisions)
    decisions.push_back({{"key", decision.key}, {"value", decision.value}});
  json["warnings"] = volume.source.warnings;
  Json& choices = json["choices"] = Json::array();
  for (const FileChoice& choice : volume.source.choices)
    choices.push_back({{"name", choice.name},
                       {"entries", choice.entries},
                       {"selected", choice.selected ? Json(*choice.selected) : Json()}});
  json["sha256"] = volume.sample_digest.empty() ? Json() : Json(volume.sample_digest);
  return json;
}

/// The path of the file that contains only this level, or null.
Json path_of_level(const std::vector<ReportFile>& files, std::size_t level) {
  for (const ReportFile& file : files)
    if (file.levels.size() == 1 && file.levels[0] == level) return file.path;
  return nullptr;
}

/// The mesh for Neuroglancer, or null.
Json neuroglancer_value(const ReportContext& context) {
  if (!context.neuroglancer) return nullptr;
  const NeuroglancerReport& mesh = *context.neuroglancer;
  Json levels = Json::array();
  for (std::size_t k = 0; k < mesh.rounding.size(); ++k)
    levels.push_back({{"largest_rounding", mesh.rounding[k]},
                      {"self_intersections", mesh.self_intersections[k]}});
  return {{"path", mesh.path},
          {"fragments", mesh.fragments},
          {"bytes", mesh.bytes},
          {"levels", std::move(levels)}};
}

Json surface_value(const SurfaceOptions& surface) {
  return {{"isovalue", surface.isovalue},
          {"inside", text(surface.inside)},
          {"tie_rule", "a sample equal to the isovalue is inside"},
          {"ambiguous_faces", "asymptotic decider"},
          {"topology", text(surface.topology)}};
}

/// @param options  lengths in world units
Json parameters_value(const ExtractOptions& options, const ExtractReport& report, int threads) {
  return {{"non_finite", text(options.surface.non_finite)},
          {"interpolation", text(options.surface.interpolation)},
          {"supersample", options.supersample},
          {"adaptive_supersample", options.adaptive_supersample},
          {"space", text(options.space)},
          {"max_radius", length_value(options.covering.max_radius)},
          {"covering", text(options.covering.strategy)},
          {"event_persistence", length_value(options.covering.event_persistence)},
          {"min_component_size", options.components.min_size},
          {"keep_components", options.components.keep_largest},
          {"keep_near", points_value(options.components.keep_near)},
          {"drop_near", points_value(options.components.drop_near)},
          {"vertices_on_surface", options.vertices_on_surface},
          {"coarse", to_value(options.coarse)},
          {"levels", options.levels},
          {"refine", goals_value(options, report)},
          {"border", text(options.border)},
          {"placement", text(options.placement)},
          {"allow_self_intersections", options.allow_self_intersections},
          {"measure_samples", options.measure_samples},
          {"threads", threads}};
}

/// Adds the keys of the result: the reference surface, its components, and the levels.
/// @param files  the files that contain the levels
void add_result(Json& json, const ExtractReport& report, const std::vector<ReportFile>& files) {
  Json& reference = json["reference"] = {{"c_vertices", report.c_vertices},
                                         {"faces", report.faces},
                                         {"double_segments", report.double_segments},
                                         {"tunnels", report.tunnels}};
  add_topology(reference, report.reference);
  for (const auto& [name, components] :
       {std::pair{"kept", &report.kept}, std::pair{"dropped", &report.dropped}}) {
    Json& list = json[name] = Json::array();
    for (const RankedComponent& component : *components) list.push_back(to_value(component));
  }
  json["coarsening"] = {
      {"rounds", report.coarsening.repair_rounds},
      {"c_vertices", report.coarser_c_vertices},
      {"certificate", report.coarser_c_vertices.empty() ? Json() : to_value(report.coarsening)}};
  json["subdivision"] = {{"c_vertices", report.subdivided_c_vertices},
                         {"added_c_vertices", report.added_c_vertices},
                         {"max_depth", report.max_subdivision_depth}};
  json["blocks"] = report.blocks ? to_value(*report.blocks) : Json();
  Json& levels = json["levels"] = Json::array();
  for (std::size_t k = 0; k < report.levels.size(); ++k) {
    Json level = {{"path", path_of_level(files, k)}};
    level.update(to_value(report.levels[k], k));
    level["rounding"] = report.levels[k].rounding;
    level["seconds"] = report.levels[k].seconds;
    levels.push_back(std::move(level));
  }
}

Json seconds_value(const ExtractReport& report, Json read, Json write) {
  Json seconds = {{"read", std::move(read)}};
  for (const StageTime& stage : report.seconds) seconds[stage.stage] = stage.seconds;
  seconds["write"] = std::move(write);
  seconds["total"] = report.total_seconds;
  return seconds;
}

}  // namespace

std::size_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;  // Linux counts KiB
}

SelfIntersectionReport find_self_intersections(const TriangleMesh& mesh,
                                               const RunControl& control) {
  constexpr std::size_t kMaxListed = 10;
  SelfIntersectionReport report;
  const std::vector<TrianglePair> pairs =
      self_intersections(mesh.positions, mesh.triangles, {}, control);
  report.pairs = pairs.size();
  for (const TrianglePair& pair : std::span(pairs).first(std::min(pairs.size(), kMaxListed)))
    report.first.push_back({pair, intersection_position(mesh.positions, mesh.triangles[pair.first],
                                                        mesh.triangles[pair.second])});
  return report;
}

std::string to_json(const ExtractReport& report, const ReportContext& context) {
  const ExtractOptions options = in_world(context.options, context.volume.grid);
  Json json;
  json["schema"] = kReportSchema;
  json["version"] = ISOATLAS_VERSION;
  json["command"] = context.command.empty() ? Json() : Json(context.command);
  json["input"] = to_value(context.volume);
  json["surface"] = surface_value(options.surface);
  json["parameters"] = parameters_value(options, report, context.threads);
  add_result(json, report, context.files);
  Json& files = json["files"] = Json::array();
  for (const ReportFile& file : context.files) files.push_back(to_value(file));
  json["neuroglancer"] = neuroglancer_value(context);
  json["seconds"] = seconds_value(report, context.read_seconds, context.write_seconds);
  json["peak_memory_bytes"] = context.peak_memory_bytes;
  return to_text(json);
}

std::string to_json(const InfoReport& info) {
  Json json;
  json["schema"] = "isoatlas-info-1";
  json["version"] = ISOATLAS_VERSION;
  json["volume"] = to_value(info.volume);
  if (info.volume.grid.sample_count() == 0)
    for (const char* key : {"sample_type", "size", "spacing", "origin", "direction"})
      json["volume"][key] = nullptr;
  const bool has_range = info.samples && info.samples->finite_count > 0;
  json["minimum"] = has_range ? Json(info.samples->minimum) : Json();
  json["maximum"] = has_range ? Json(info.samples->maximum) : Json();
  json["nan"] = info.samples ? Json(info.samples->nan_count) : Json();
  json["infinite"] = info.samples ? Json(info.samples->infinity_count) : Json();
  Json& isovalues = json["isovalues"] = Json::array();
  for (const InfoReport::Isovalue& isovalue : info.isovalues)
    isovalues.push_back({{"value", isovalue.value}, {"reason", isovalue.reason}});
  return to_text(json);
}

std::string level_json(const LevelReport& level, std::size_t number) {
  return to_value(level, number).dump();
}

std::string levels_manifest(const std::vector<ReportFile>& files,
                            const std::vector<std::string>& levels) {
  Json json;
  json["schema"] = "isoatlas-manifest-2";
  json["version"] = ISOATLAS_VERSION;
  Json& list = json["levels"] = Json::array();
  for (std::size_t k = 0; k < files.size(); ++k) {
    Json level = {{"file", std::filesystem::path(files[k].path).filename().string()},
                  {"bytes", files[k].bytes},
                  {"largest_rounding", files[k].largest_rounding}};
    if (!levels.empty()) level.update(Json::parse(levels[k]));
    list.push_back(std::move(level));
  }
  return to_text(json);
}

std::string to_json(const std::string& mesh_path, const MeshTopology& topology,
                    const MeshExtent& extent, const MeshQuality& quality,
                    const SelfIntersectionReport* self_intersections,
                    const DistanceReport* distance) {
  Json json;
  json["schema"] = "isoatlas-check-1";
  json["version"] = ISOATLAS_VERSION;
  json["path"] = path_value(mesh_path);
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
  const bool is_oriented_manifold = topology.is_manifold() && topology.is_oriented();
  if (is_oriented_manifold) {
    add_topology(json, summarize(topology.components));
  } else {
    json["components"] = topology.components.size();
    for (const char* key : {"euler_characteristic", "genus", "boundary_loops", "kinds"})
      json[key] = nullptr;
  }
  json["extent"] = to_value(extent, is_oriented_manifold);
  json["quality"] = to_value(quality);
  json["self_intersections"] = self_intersections ? to_value(*self_intersections) : Json();
  json["distance"] = distance ? to_value(*distance) : Json();
  return to_text(json);
}

}  // namespace isoatlas::detail

namespace isoatlas {

std::string to_json(const ExtractReport& report) try {
  using namespace detail;
  report::Json json = {{"schema", kReportSchema}, {"version", ISOATLAS_VERSION}};
  for (const char* key : {"command", "input", "surface", "parameters"}) json[key] = nullptr;
  add_result(json, report, {});
  json["files"] = report::Json::array();
  json["neuroglancer"] = nullptr;
  json["seconds"] = seconds_value(report, nullptr, nullptr);
  json["peak_memory_bytes"] = nullptr;
  return report::to_text(json);
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory for the text of this report");
}

}  // namespace isoatlas
