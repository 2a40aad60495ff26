// SPDX-License-Identifier: Apache-2.0
#include "report/level_facts.h"

#include <limits>
#include <string>
#include <type_traits>

#include "isoatlas/error.h"
#include "isoatlas/version.h"
#include "report/json_values.h"

namespace isoatlas::detail {

using report::Json;

namespace {

[[noreturn]] void refuse(const char* key, const Json& value, const char* expected) {
  constexpr std::size_t kMaxShown = 40;
  throw Error(ErrorCode::bad_file, std::string(key) + " is " +
                                       value.dump(-1, ' ', true).substr(0, kMaxShown) +
                                       ", expected " + expected);
}

/// Reads a value if the key exists. The type is checked here because nlohmann converts -1, 1.5 and
/// true to counts.
template <class Value>
void read(const Json& object, const char* key, Value& value) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return;
  if constexpr (std::is_floating_point_v<Value>) {
    if (!found->is_number()) refuse(key, *found, "a number");
  } else if constexpr (std::is_unsigned_v<Value>) {
    if (!found->is_number_unsigned()) refuse(key, *found, "a whole number, 0 or more");
  } else if (!found->is_number_integer()) {
    refuse(key, *found, "a whole number");
  }
  found->get_to(value);
}

void read_metric(const Json& object, const char* key, double& value) {
  if (object.contains(key) && object[key].is_null())
    value = std::numeric_limits<double>::infinity();
  else
    read(object, key, value);
}

Json member(const Json& object, const char* key) {
  return object.is_object() && object.contains(key) ? object[key] : Json();
}

OneSidedDistance distance_of(const Json& json) {
  OneSidedDistance distance;
  read(json, "samples", distance.samples);
  read(json, "samples_per_voxel_face", distance.samples_per_voxel_face);
  read(member(json, "world"), "maximum", distance.maximum);
  return distance;
}

Measurement measurement_of(const Json& json) {
  Measurement measured;
  measured.mesh_to_surface = distance_of(member(json, "mesh_to_surface"));
  measured.surface_to_mesh = distance_of(member(json, "surface_to_mesh"));
  return measured;
}

LevelFacts facts_of(const Json& json) {
  LevelFacts facts;
  read(json, "vertices", facts.vertices);
  read(json, "triangles", facts.triangles);
  read(json, "components", facts.topology.components);
  read(json, "euler_characteristic", facts.topology.euler_characteristic);
  read(json, "genus", facts.topology.genus);
  read(json, "boundary_loops", facts.topology.boundary_loops);
  const Json aspect = member(member(json, "quality"), "aspect_ratio");
  read(aspect, "minimum", facts.quality.aspect_min);
  read(aspect, "p01", facts.quality.aspect_p01);
  read(aspect, "median", facts.quality.aspect_median);
  read(aspect, "share_below_third", facts.quality.aspect_share_below_third);
  read(member(member(json, "quality"), "angle_degrees"), "minimum", facts.quality.angle_min);
  if (const Json measured = member(json, "measured"); measured.is_object())
    facts.measured = measurement_of(measured);
  if (const Json at_most = member(json, "distance_at_most"); !at_most.is_null())
    read_metric(json, "distance_at_most", facts.distance_at_most.emplace());
  const Json metrics = member(json, "metrics");
  for (std::size_t i = 0; i < kMetricCount; ++i) {
    const Json metric = member(metrics, std::string(name(static_cast<Quantity>(i))).c_str());
    if (!metric.is_object()) continue;
    read_metric(metric, "maximum", facts.metrics[i].emplace().maximum);
    read_metric(metric, "mean", facts.metrics[i]->mean);
  }
  return facts;
}

/// Calls `read` with the parsed text. All errors become Errors that name the file.
template <class Read>
auto read_json(const std::string& text, const std::string& path, Read read) {
  try {
    return read(Json::parse(text));
  } catch (const Error& error) {
    throw Error(error.code(), path + ": " + error.what());
  } catch (const Json::exception& error) {
    throw Error(ErrorCode::bad_file, path + ": is not JSON of isoatlas: " + error.what());
  }
}

}  // namespace

std::optional<LevelFacts> facts_of_level(const std::string& text, const std::string& path) {
  return read_json(text, path, [](const Json& json) {
    return json.is_object() ? std::optional(facts_of(json)) : std::nullopt;
  });
}

std::vector<LevelFacts> facts_of_levels(const std::string& text, const std::string& path) {
  return read_json(text, path, [](const Json& json) {
    const Json schema = member(json, "schema");
    if (schema != "isoatlas-report-3" && schema != "isoatlas-manifest-2")
      throw Error(ErrorCode::unsupported,
                  "is not a report of isoatlas extract, expected the schema isoatlas-report-3 or "
                  "isoatlas-manifest-2");
    std::vector<LevelFacts> levels;
    for (const Json& level : member(json, "levels"))
      if (level.is_object()) levels.push_back(facts_of(level));
    if (levels.empty()) throw Error(ErrorCode::bad_file, "has no levels");
    return levels;
  });
}

std::string to_json(const std::string& path, const std::vector<LevelFacts>& levels,
                    std::optional<bool> nested) {
  Json json;
  json["schema"] = "isoatlas-levels-1";
  json["version"] = ISOATLAS_VERSION;
  json["path"] = path;
  json["nested"] = nested ? Json(*nested) : Json();
  Json& list = json["levels"] = Json::array();
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const LevelFacts& level = levels[k];
    Json one = {{"level", k},
                {"vertices", level.vertices},
                {"triangles", level.triangles},
                {"manifold", level.is_manifold ? Json(*level.is_manifold) : Json()}};
    const auto add = [&](const char* key, auto value) {
      one[key] = level.is_manifold.value_or(true) ? Json(value) : Json();
    };
    one["components"] = level.topology.components;
    add("euler_characteristic", level.topology.euler_characteristic);
    add("genus", level.topology.genus);
    add("boundary_loops", level.topology.boundary_loops);
    one["aspect_ratio"] = {{"minimum", level.quality.aspect_min},
                           {"p01", level.quality.aspect_p01},
                           {"median", level.quality.aspect_median},
                           {"share_below_third", level.quality.aspect_share_below_third}};
    one["angle_degrees"] = {{"minimum", level.quality.angle_min}};
    const auto side = [](const OneSidedDistance& distance) {
      return Json{{"samples", distance.samples},
                  {"samples_per_voxel_face", distance.samples_per_voxel_face},
                  {"maximum", distance.maximum}};
    };
    one["distance_at_most"] = level.distance_at_most ? Json(*level.distance_at_most) : Json();
    one["measured"] = level.measured
                          ? Json{{"maximum", level.measured->maximum()},
                                 {"mesh_to_surface", side(level.measured->mesh_to_surface)},
                                 {"surface_to_mesh", side(level.measured->surface_to_mesh)}}
                          : Json();
    for (std::size_t i = 0; i < kMetricCount; ++i)
      one["metrics"][std::string(name(static_cast<Quantity>(i)))] =
          level.metrics[i]
              ? Json({{"maximum", level.metrics[i]->maximum}, {"mean", level.metrics[i]->mean}})
              : Json();
    list.push_back(std::move(one));
  }
  return report::to_text(json);
}

}  // namespace isoatlas::detail
