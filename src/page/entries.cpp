// SPDX-License-Identifier: Apache-2.0
// The facts about a result: from its report, from its mesh files, or counted.
#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "core/file_name.h"
#include "isoatlas/error.h"
#include "isoatlas/extract.h"
#include "isoatlas/mesh_file.h"
#include "isoatlas/text_file.h"
#include "isoatlas/volume_file.h"
#include "page/file_names.h"
#include "page/page.h"
#include "report/json_values.h"

namespace isoatlas::detail {
namespace {

namespace fs = std::filesystem;
using report::Json;

constexpr std::size_t kMaxListed = 20;  // bad triangles that a page lists

// Standard input or output in a report. Its data cannot be read again.
constexpr const char* kStream = "-";

[[noreturn]] void bad_report(const std::string& path, const std::string& what) {
  throw Error(ErrorCode::bad_file, path + ": " + what);
}

// Removes long lists, which a page does not show, and times and paths, so that the page of the same
// result is the same in each run.
void shorten(Json& level) {
  for (const char* key : {"at_limit", "seconds", "path"}) level.erase(key);
  if (!level.contains("bad_triangles") || !level["bad_triangles"].is_object()) return;
  Json& worst = level["bad_triangles"]["worst"];
  if (worst.is_array() && worst.size() > kMaxListed)
    worst.erase(worst.begin() + kMaxListed, worst.end());
}

// The facts that can be counted from a mesh, with the keys of a level in a report.
Json counted(const TriangleMesh& mesh, std::size_t number) {
  const MeshTopology topology = mesh_topology(mesh);
  Json level = {
      {"level", number}, {"vertices", topology.vertices}, {"triangles", topology.triangles}};
  const bool manifold = topology.is_manifold() && topology.is_oriented();
  level["manifold"] = manifold;
  report::add_topology(level, summarize(topology.components));
  if (!manifold) {
    for (const char* key : {"euler_characteristic", "genus", "boundary_loops", "kinds"})
      level[key] = nullptr;
  }
  level["extent"] = report::to_value(summarize(component_extents(mesh, topology)), manifold);
  level["quality"] = report::to_value(mesh_quality(mesh));
  return level;
}

// True if the stated facts about a level agree with those counted on its triangles. `stated` can be
// any JSON.
bool agree(const Json& stated, const Json& counted) {
  if (!stated.is_object()) return false;
  for (const char* key :
       {"vertices", "triangles", "components", "euler_characteristic", "genus", "boundary_loops"})
    if (!stated.contains(key) || stated[key] != counted[key]) return false;
  return true;
}

// File names can contain bytes that are not UTF-8.
std::string text_of(const Json& facts) {
  return facts.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json empty_facts(const std::string& title) {
  return {{"title", title},   {"unit", "units"},    {"command", nullptr},  {"parameters", nullptr},
          {"input", nullptr}, {"surface", nullptr}, {"reference", nullptr}};
}

Json to_value(const std::optional<MeshQuality>& marching_cubes) {
  if (!marching_cubes) return nullptr;
  return {{"triangles", marching_cubes->triangles},
          {"histogram", marching_cubes->aspect_histogram},
          {"share_below_third", marching_cubes->aspect_share_below_third},
          {"minimum", marching_cubes->aspect_min}};
}

Json parsed_report(const std::string& text, const std::string& path) {
  Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("schema") || json["schema"] != "isoatlas-report-3")
    bad_report(path, "is not a report of isoatlas extract (schema isoatlas-report-3)");
  for (const char* key : {"input", "surface", "parameters", "reference"})
    if (!json.contains(key) || !json[key].is_object())
      bad_report(path, std::string("has no '") + key + "'");
  for (const char* key : {"levels", "files"})
    if (!json.contains(key) || !json[key].is_array())
      bad_report(path, std::string("has no '") + key + "'");
  return json;
}

// The path of a file that a report names: `path` if it exists, otherwise the same name in the
// folder of the report.
fs::path find_file(const std::string& path, const fs::path& report) {
  std::error_code ignored;
  if (fs::exists(path, ignored)) return path;
  return report.parent_path() / fs::path(path).filename();
}

HierarchyFile read_named_levels(const fs::path& path, const fs::path& report) {
  try {
    return read_levels(path);
  } catch (const Error& error) {
    throw Error(error.code(), report.string() + ": its file " + error.what());
  }
}

// The levels in the files of a report.
struct FoundLevels {
  Hierarchy hierarchy;
  std::vector<std::size_t> numbers;  // of the levels of `hierarchy` in the report
  std::vector<fs::path> files;
  bool nested = true;  // a vertex has the same index in all levels that contain it
};

// Reads all levels for which files exist: from one file with all levels, or from one file per
// level.
FoundLevels levels_of_report(const Json& json, const fs::path& report) {
  std::vector<std::pair<std::size_t, fs::path>> single;
  for (const Json& file : json["files"]) {
    if (file.at("path") == kStream) continue;
    const fs::path path = find_file(file.at("path").get<std::string>(), report);
    const auto levels = file.at("levels").get<std::vector<std::size_t>>();
    if (is_hierarchy_path(path) && levels.size() == json["levels"].size())
      return {read_named_levels(path, report).hierarchy, levels,
              files_of_hierarchy(path, levels.size())};
    if (levels.size() == 1) single.emplace_back(levels.front(), path);
  }
  std::stable_sort(single.begin(), single.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<TriangleMesh> meshes;
  FoundLevels out;
  for (const auto& [number, path] : single) {
    if (!out.numbers.empty() && out.numbers.back() == number) continue;
    out.numbers.push_back(number);
    out.files.push_back(path);
    out.nested = out.nested && lower_case_extension(path) != ".stl";  // .stl has no vertex indices
    meshes.push_back(read_named_levels(path, report).hierarchy.mesh(0));
  }
  if (meshes.empty()) bad_report(report.string(), "names no file with a mesh");
  out.hierarchy = hierarchy_of(std::move(meshes));
  return out;
}

// Summary of the kept or the dropped components: their number, the number of their parts, and the
// size of the largest part.
Json sizes_of(const Json& components) {
  const auto first = components.front().at("part").get<std::size_t>(),
             last = components.back().at("part").get<std::size_t>();
  return {{"components", components.size()},
          {"parts", last - first + 1},
          {"largest", components.front().at("size")}};
}

// The path of the volume of a report; empty if it came from memory or from standard input.
std::string volume_of(const Json& json) {
  const Json& path = json["input"].at("path");
  return path.is_null() || path == kStream ? std::string() : path.get<std::string>();
}

// Options that select the same volume of a file again.
ReadOptions read_options_of(const Json& json) {
  ReadOptions options;
  for (const Json& choice : json["input"].value("choices", Json::array())) {
    const std::string choice_name = choice.at("name").get<std::string>();
    if (!choice.at("selected").is_number_unsigned()) continue;
    const auto selected = choice.at("selected").get<std::size_t>();
    if (choice_name == "channel") options.channel = std::to_string(selected);
    if (choice_name == "time") options.time = selected;
    if (choice_name == "layer") options.layer = std::to_string(selected);
    if (choice_name == "array")
      options.array = choice.at("entries").at(selected).get<std::string>();
    if (choice_name == "series") options.series = std::to_string(selected);
  }
  return options;
}

// A point of each kept component, in sample-index coordinates; empty if all were kept.
std::vector<Vec3> kept_points(const Json& json, const Grid& grid) {
  std::vector<Vec3> positions;
  for (const Json& component : json.at("kept")) {
    const auto p = component.at("position").get<std::array<double, 3>>();
    positions.push_back({p[0], p[1], p[2]});
  }
  const std::string space = json["parameters"].at("space").get<std::string>();
  return to_index(std::move(positions), grid,
                  space == "voxel" ? Space::voxel
                  : space == "ras" ? Space::ras
                                   : Space::lps);
}

// Marching cubes on the volume at `path`. Absent if the file does not exist any more, needs a raw
// layout, or has other samples than those that were meshed.
std::optional<MeshQuality> marching_cubes_of(const Json& json, const fs::path& path) {
  try {
    const Volume volume = read_volume(path, read_options_of(json));
    if (volume.view.grid.size != json["input"].at("size").get<std::array<std::size_t, 3>>())
      return std::nullopt;
    const Json digest = json["input"].value("sha256", Json());
    if (digest.is_string() && digest != sample_digest(volume)) return std::nullopt;
    return marching_cubes_quality(volume, json["surface"].at("isovalue").get<double>(),
                                  kept_points(json, volume.view.grid));
  } catch (const Error&) {
    return std::nullopt;
  }
}

// @param numbers  for each level of the hierarchy its number in the report
PageEntry entry_of(const Json& json, const std::string& path, Hierarchy hierarchy,
                   const std::vector<std::size_t>& numbers,
                   const std::optional<MeshQuality>& marching_cubes, bool nested = true) {
  const std::string volume = volume_of(json);
  const std::string name = page::file_name(volume.empty() ? path : volume);
  std::array<char, 32> isovalue{};
  std::snprintf(isovalue.data(), isovalue.size(), "%g",
                json["surface"].at("isovalue").get<double>());
  Json facts = empty_facts(name + " at " + isovalue.data());
  const Json unit = json["input"].value("unit", Json());
  facts["unit"] = unit.is_string() ? unit : Json("units");
  const Json command = json.value("command", Json());
  if (command.is_string())
    facts["command"] = page::with_file_names(command.get<std::string>(), volume);
  for (const char* key : {"parameters", "input", "surface", "reference"}) facts[key] = json[key];
  if (!volume.empty()) facts["input"]["path"] = name;
  for (const char* choice : {"kept", "dropped"}) {
    if (json.contains(choice) && !json[choice].empty()) facts[choice] = sizes_of(json[choice]);
  }
  if (hierarchy.levels.size() != numbers.size())
    bad_report(path, "is about another mesh: it has another number of levels");
  Json& levels = facts["levels"] = Json::array();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] >= json["levels"].size())
      bad_report(path, "has no level " + std::to_string(numbers[i]));
    Json level = json["levels"][numbers[i]];
    if (!agree(level, counted(hierarchy.mesh(i), numbers[i])))
      bad_report(path,
                 "is about another mesh: level " + std::to_string(numbers[i]) + " differs from it");
    shorten(level);
    levels.push_back(std::move(level));
  }
  facts["marching_cubes"] = to_value(marching_cubes);
  facts["nested"] = nested;
  return {std::move(hierarchy), text_of(facts)};
}

}  // namespace

PageEntry entry_of_report(const std::string& report, const std::string& path, Hierarchy hierarchy,
                          const std::optional<MeshQuality>& marching_cubes) {
  const Json json = parsed_report(report, path);
  std::vector<std::size_t> numbers;
  for (std::size_t k = 0; k < hierarchy.levels.size(); ++k) numbers.push_back(k);
  try {
    return entry_of(json, path, std::move(hierarchy), numbers, marching_cubes);
  } catch (const Json::exception& error) {
    bad_report(path, std::string("a key is missing or has a wrong type: ") + error.what());
  }
}

PageEntry entry_of_levels(HierarchyFile file, const std::string& title) {
  PageEntry entry;
  entry.hierarchy = std::move(file.hierarchy);
  Json facts = empty_facts(title);
  facts["unit"] = "units";  // mesh formats do not state it
  const std::vector<std::string>& stated = file.info.levels;
  Json& levels = facts["levels"] = Json::array();
  for (std::size_t k = 0; k < entry.hierarchy.levels.size(); ++k) {
    const Json from_file = stated.empty() ? Json() : Json::parse(stated[k]);
    Json level = counted(entry.hierarchy.mesh(k), k);
    if (agree(from_file, level)) level.update(from_file);
    shorten(level);
    levels.push_back(std::move(level));
  }
  facts["marching_cubes"] = nullptr;
  facts["nested"] = true;
  entry.facts = text_of(facts);
  return entry;
}

PageEntry entry_of_file(const fs::path& path) {
  if (lower_case_extension(path) == ".json") {
    const Json json = parsed_report(read_text_file(path), path.string());
    try {
      FoundLevels levels = levels_of_report(json, path);
      const std::string volume = volume_of(json);
      const fs::path volume_path = volume.empty() ? fs::path() : find_file(volume, path);
      const auto marching_cubes =
          volume.empty() ? std::nullopt : marching_cubes_of(json, volume_path);
      PageEntry entry = entry_of(json, path.string(), std::move(levels.hierarchy), levels.numbers,
                                 marching_cubes, levels.nested);
      entry.sources = std::move(levels.files);
      entry.sources.push_back(path);
      if (!volume.empty()) entry.sources.push_back(volume_path);
      return entry;
    } catch (const Json::exception& error) {
      bad_report(path.string(),
                 std::string("a key is missing or has a wrong type: ") + error.what());
    }
  }
  HierarchyFile file = read_levels(path);
  std::vector<fs::path> sources = is_hierarchy_path(path)
                                      ? files_of_hierarchy(path, file.hierarchy.levels.size())
                                      : std::vector{path};
  PageEntry entry = entry_of_levels(std::move(file), path.filename().string());
  entry.sources = std::move(sources);
  return entry;
}

}  // namespace isoatlas::detail
