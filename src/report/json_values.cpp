// SPDX-License-Identifier: Apache-2.0
#include "report/json_values.h"

#include <algorithm>
#include <string_view>

namespace isoatlas::detail::report {
namespace {

// Length limit of the lists of worst cells and triangles. A noisy volume can have many more.
constexpr std::size_t kMaxListed = 1000;

std::string_view text(Unit unit) {
  switch (unit) {
    case Unit::length:
      return "world";
    case Unit::ratio:
      return "ratio";
    case Unit::degrees:
      return "degrees";
    case Unit::count:
      return "count";
    case Unit::number:
      return "number";
  }
  return "";
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

// A path can contain bytes that are not UTF-8. They become replacement characters, so that there is
// always a report.
std::string on_one_line(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

bool is_flat(const Json& value) {
  return std::none_of(value.begin(), value.end(), [](const Json& item) {
    return item.is_object() || (item.is_array() && !item.empty() && item[0].is_structured());
  });
}

/// True for numbers, texts, lists of these and small flat objects. A flat object of any size fits
/// if it is an item of a list.
bool fits_on_a_line(const Json& value, bool in_list) {
  constexpr std::size_t kMaxKeys = 3;
  if (value.is_object()) return is_flat(value) && (in_list || value.size() <= kMaxKeys);
  return !value.is_array() || value.empty() || !value[0].is_object();
}

void print(const Json& value, std::string& text, const std::string& indent, bool in_list) {
  if (fits_on_a_line(value, in_list)) {
    text += on_one_line(value);
    return;
  }
  text += value.is_array() ? '[' : '{';
  bool first = true;
  for (const auto& [key, item] : value.items()) {
    if (!first) text += ',';
    first = false;
    text += indent + "  ";
    if (value.is_object()) text += on_one_line(Json(key)) + ": ";
    print(item, text, indent + "  ", value.is_array());
  }
  text += indent;
  text += value.is_array() ? ']' : '}';
}

Json constraint_value(const ConstraintResult& result) {
  return {{"quantity", name(result.constraint)},
          {"bound", result.constraint.bound},
          {"reached", result.reached},
          {"unit", text(unit(result.constraint.quantity))},
          {"satisfied", result.satisfied},
          {"default", result.constraint.is_default},
          {"reason", result.satisfied ? Json() : Json(result.reason)}};
}

Json metrics_value(const LevelReport& level) {
  Json metrics;
  if (!level.metrics) return metrics;
  for (std::size_t i = 0; i < kMetricCount; ++i) {
    const auto metric = static_cast<Quantity>(i);
    metrics[std::string(name(metric))] = {{"maximum", (*level.metrics)[i].maximum},
                                          {"mean", (*level.metrics)[i].mean},
                                          {"unit", text(unit(metric))}};
  }
  return metrics;
}

}  // namespace

Json to_value(Vec3 v) { return Json::array({v.x, v.y, v.z}); }

Json to_value(const std::optional<double>& length) { return length ? Json(*length) : Json(); }

void add_topology(Json& object, const TopologySummary& topology) {
  object["components"] = topology.components;
  object["euler_characteristic"] = topology.euler_characteristic;
  object["genus"] = topology.genus;
  object["boundary_loops"] = topology.boundary_loops;
  Json kinds = Json::array();
  for (const TopologySummary::Kind& kind : topology.kinds)
    kinds.push_back(
        {{"genus", kind.genus}, {"boundary_loops", kind.boundary_loops}, {"count", kind.count}});
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
  return {
      {"aspect_ratio",
       {{"minimum", quality.aspect_min},
        {"p01", quality.aspect_p01},
        {"median", quality.aspect_median},
        {"share_below_third", quality.aspect_share_below_third},
        {"histogram", quality.aspect_histogram}}},
      {"angle_degrees",
       {{"minimum", quality.angle_min},
        {"maximum", quality.angle_max},
        {"above_150", quality.angles_above_150}}},
      {"dihedral_degrees", {{"minimum", quality.dihedral_min}, {"maximum", quality.dihedral_max}}},
      {"edge_length", {{"minimum", quality.edge_min}, {"maximum", quality.edge_max}}},
      {"zero_area_triangles", quality.zero_area_triangles}};
}

Json to_value(const MeshExtent& extent, bool is_oriented_manifold) {
  Json largest = Json::array();
  for (const ComponentExtent& component : extent.largest) {
    const auto counted = [&](std::int64_t count) {
      return is_oriented_manifold ? Json(count) : Json();
    };
    largest.push_back({{"component", component.component},
                       {"triangles", component.triangles},
                       {"low", to_value(component.bounds.low)},
                       {"high", to_value(component.bounds.high)},
                       {"area", component.area},
                       {"volume", to_value(component.volume)},
                       {"genus", counted(component.topology.genus())},
                       {"boundary_loops", counted(component.topology.boundary_loops)}});
  }
  const bool is_empty = extent.components == 0;
  return {{"low", is_empty ? Json() : to_value(extent.bounds.low)},
          {"high", is_empty ? Json() : to_value(extent.bounds.high)},
          {"area", extent.area},
          {"volume", to_value(extent.volume)},
          {"open_components", extent.open_components},
          {"largest", std::move(largest)}};
}

Json to_value(const Measurement& measurement) {
  const OneSidedDistance& from_mesh = measurement.mesh_to_surface;
  const OneSidedDistance& from_surface = measurement.surface_to_mesh;
  return {{"voxel", measurement.voxel},
          {"maximum", std::max(from_mesh.maximum, from_surface.maximum)},
          {"p99", std::max(from_mesh.p99, from_surface.p99)},
          {"mean", std::max(from_mesh.mean, from_surface.mean)},
          {"mesh_to_surface", one_side(from_mesh, measurement.voxel)},
          {"surface_to_mesh", one_side(from_surface, measurement.voxel)},
          {"normal_degrees",
           {{"mean", measurement.normal_mean},
            {"p99", measurement.normal_p99},
            {"maximum", measurement.normal_maximum}}},
          {"surface_area", measurement.surface_area},
          {"mesh_area", measurement.mesh_area}};
}

Json to_value(const LevelGoal& goal) {
  Json list = Json::array();
  for (const Constraint& constraint : goal)
    list.push_back({{"quantity", name(constraint)}, {"bound", constraint.bound}});
  return list;
}

std::string_view text(ShapeObstacle obstacle) {
  switch (obstacle) {
    case ShapeObstacle::none:
      return "none";
    case ShapeObstacle::earlier_level:
      return "earlier-level";
    case ShapeObstacle::self_intersection:
      return "self-intersection";
    case ShapeObstacle::multi_sheet:
      return "multi-sheet";
  }
  return "";
}

Json to_value(const LevelReport& level, std::size_t number) {
  Json json = {{"level", number}, {"vertices", level.vertices}, {"triangles", level.triangles}};
  add_topology(json, level.topology);
  json["inverted_components"] = level.inverted_components;
  json["caps"] = level.caps
                     ? Json({{"triangles", level.caps->triangles}, {"area", level.caps->area}})
                     : Json();
  json["certificate"] = to_value(level.certificate);
  json["extent"] = to_value(level.extent);
  json["quality"] = to_value(level.quality);
  json["metrics"] = metrics_value(level);
  json["distance_at_most"] = level.distance_at_most ? Json(*level.distance_at_most) : Json();
  Json& constraints = json["constraints"] = Json::array();
  for (const ConstraintResult& result : level.constraints)
    constraints.push_back(constraint_value(result));
  Json worst = Json::array();
  for (std::size_t i = 0; i < std::min(level.at_limit.size(), kMaxListed); ++i)
    worst.push_back(
        {{"position", to_value(level.at_limit[i].position)}, {"excess", level.at_limit[i].excess}});
  json["at_limit"] = {{"count", level.at_limit.size()}, {"worst", std::move(worst)}};
  json["refine_rounds"] = level.refine_rounds;
  json["flips"] = level.flips;
  json["moves"] = level.moves;
  json["displacements"] = level.displacements;
  Json bad = Json::array();
  for (std::size_t i = 0; i < std::min(level.bad_triangles.size(), kMaxListed); ++i) {
    const BadTriangle& t = level.bad_triangles[i];
    bad.push_back({{"position", to_value(t.position)},
                   {"aspect_ratio", t.aspect_ratio},
                   {"largest_angle", t.largest_angle},
                   {"obstacle", text(t.obstacle)}});
  }
  json["bad_triangles"] = {{"count", level.bad_triangles.size()}, {"worst", std::move(bad)}};
  json["self_intersections"] = level.self_intersections ? Json(*level.self_intersections) : Json();
  Json& positions = json["self_intersection_positions"] = Json::array();
  for (const Vec3& position : level.self_intersection_positions)
    positions.push_back(to_value(position));
  json["sites_for_intersections"] = level.sites_for_intersections;
  json["measured"] = level.measured ? to_value(*level.measured) : Json();
  return json;
}

std::string to_text(const Json& json) {
  std::string text;
  print(json, text, "\n", false);
  return text + "\n";
}

}  // namespace isoatlas::detail::report
