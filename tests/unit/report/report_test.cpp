// SPDX-License-Identifier: Apache-2.0
#include "report/report.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "isoatlas/error.h"
#include "isoatlas/json.h"
#include "report/level_facts.h"

namespace isoatlas::detail {
namespace {

ConstraintResult result_of(Quantity quantity, double bound, bool is_default, double reached,
                           bool satisfied, const char* reason) {
  ConstraintResult out;
  out.constraint.quantity = quantity;
  out.constraint.bound = bound;
  out.constraint.is_default = is_default;
  out.reached = reached;
  out.satisfied = satisfied;
  out.reason = reason;
  return out;
}

using Json = nlohmann::json;

// A report in which no key is null or empty.
struct FullReport {
  ExtractReport report;
  ReportContext context;

  FullReport() {
    report.coarser_c_vertices = {100};
    report.reference.kinds = {{0, 0, 1}};
    report.kept = {{{4, 5, 6}, 0, 9.5, 80, {2, 0}}};
    report.dropped = {{{1, 2, 3}, 1, 0.5, 8, {2, 0}}};
    report.levels.resize(2);
    for (std::size_t k = 0; k < 2; ++k) {
      LevelReport& level = report.levels[k];
      level.vertices = 10 + k;
      level.triangles = 20 + k;
      level.topology = {.components = 1,
                        .euler_characteristic = 2,
                        .genus = 0,
                        .boundary_loops = 0,
                        .kinds = {{0, 0, 1}}};
      level.quality.aspect_median = 0.5;
      level.extent = summarize({{0, 20, {{1, 2, 3}, {4, 5, 6}}, 9.5, 1.5, {2, 0}}});
      level.metrics.emplace()[0] = {2.5, 0.5};
      level.constraints.push_back(
          result_of(Quantity::max_vertices, 5, false, 10, false, "topology needs 10"));
      level.constraints.push_back(result_of(Quantity::max_distance, 3, false, 2.5, true, "unused"));
      level.at_limit.assign(1200, {{1, 2, 3}, 1.5});
      level.bad_triangles.assign(1200, {{1, 2, 3}, 0.2, 95, ShapeObstacle::earlier_level});
      level.caps = {.triangles = 4, .area = 6.5};
      level.self_intersections = 0;
      level.measured.emplace();
      level.measured->voxel = 2;
      level.measured->mesh_to_surface.maximum = 3;
      level.measured->surface_to_mesh.maximum = 4;
    }
    report.blocks = {.block_size = {64, 64, 64}, .counts = {2, 1, 1}, .with_surface = 2};
    report.seconds = {{"surface", 1}, {"components", 1}, {"coarsen", 1}, {"cover", 1},
                      {"certify", 1}, {"mesh", 1},       {"check", 1},   {"refine", 1}};
    context.volume.path = "v.nrrd";
    context.volume.source.decisions = {{"affine", "sform"}};
    context.volume.source.choices = {{"channel", {"DAPI", "GFP"}, 1}};
    context.files = {{"a.glb", {0, 1}, 99, true, 0.25}, {"a-1.glb", {1}, 9, true, 0.5}};
    context.neuroglancer = {"ng", 9, 99, {0.5, 0.25}, {1, 0}};
    context.options.coarse = {{Quantity::max_vertices, 5}};
    context.options.refine = {{{Quantity::max_distance, 3}}};
  }
  Json json() const { return Json::parse(to_json(report, context)); }
};

void add_leaves(const Json& value, const std::string& path, std::set<std::string>& leaves) {
  if (value.is_object()) {
    for (const auto& [key, item] : value.items())
      add_leaves(item, path.empty() ? key : path + "." + key, leaves);
  } else if (value.is_array() && !value.empty() && value[0].is_object()) {
    for (const Json& item : value) add_leaves(item, path + "[]", leaves);
  } else {
    leaves.insert(path);
  }
}

std::set<std::string> documented(const std::string& schema) {
  std::ifstream page(ISOATLAS_REPORT_PAGE);
  std::set<std::string> keys;
  bool is_inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("## ")) is_inside = line == "## " + schema;
    if (is_inside && line.starts_with("| `")) keys.insert(line.substr(3, line.find('`', 3) - 3));
  }
  return keys;
}

// No single run of the tool has all keys; tests/cli compares those of actual runs.
TEST(Report, HasTheDocumentedKeysAndNoOthers) {
  std::set<std::string> leaves;
  add_leaves(FullReport().json(), "", leaves);
  EXPECT_EQ(leaves, documented("isoatlas-report-3"));
}

// The library's own document differs in what extract() does not know, and in nothing else.
TEST(Report, ToJsonOfTheLibraryHasTheSameResult) {
  const FullReport full;
  Json expected = full.json();
  for (const char* key :
       {"command", "input", "surface", "parameters", "peak_memory_bytes", "neuroglancer"})
    expected[key] = nullptr;
  for (Json& level : expected["levels"]) level["path"] = nullptr;
  expected["files"] = Json::array();
  for (const char* key : {"read", "write"}) expected["seconds"][key] = nullptr;
  EXPECT_EQ(Json::parse(to_json(full.report)), expected);
}

TEST(Report, Levels) {
  const Json json = FullReport().json();
  EXPECT_EQ(json["schema"], "isoatlas-report-3");
  ASSERT_EQ(json["levels"].size(), 2U);
  const Json& level = json["levels"][1];
  EXPECT_TRUE(json["levels"][0]["path"].is_null());
  EXPECT_EQ(level["path"], "a-1.glb");
  EXPECT_EQ(level["constraints"][0]["quantity"], "max-vertices");
  EXPECT_EQ(level["constraints"][0]["reason"], "topology needs 10");
  EXPECT_TRUE(level["constraints"][1]["reason"].is_null());
  EXPECT_EQ(level["constraints"][1]["unit"], "world");
  EXPECT_EQ(level["at_limit"]["count"], 1200);
  EXPECT_EQ(level["at_limit"]["worst"].size(), 1000U);
  EXPECT_EQ(level["metrics"]["max-distance"]["maximum"], 2.5);
  EXPECT_EQ(level["measured"]["maximum"], 4);
  EXPECT_EQ(level["measured"]["mesh_to_surface"]["voxels"]["maximum"], 1.5);
  EXPECT_EQ(json["files"][1]["largest_rounding"], 0.5);
  EXPECT_EQ(json["parameters"]["refine"][0][0]["quantity"], "max-distance");
}

TEST(Report, Extents) {
  FullReport full;
  std::vector<ComponentExtent> components;
  for (std::uint32_t c = 0; c < 200; ++c) {
    const std::optional<double> volume = c % 2 == 0 ? std::optional(1.0) : std::nullopt;
    components.push_back({c, 4, {{0, 0, 0}, {1, 1, 1}}, 1.0 + c, volume, {2, c % 2}});
  }
  full.report.levels[1].extent = summarize(components);
  const Json extent = full.json()["levels"][1]["extent"];
  EXPECT_EQ(extent["volume"], 100);
  EXPECT_EQ(extent["open_components"], 100);
  ASSERT_EQ(extent["largest"].size(), 100u);
  EXPECT_EQ(extent["largest"][0]["component"], 199);
  EXPECT_TRUE(extent["largest"][0]["volume"].is_null());
  EXPECT_EQ(extent["largest"][0]["boundary_loops"], 1);
  EXPECT_EQ(extent["largest"][1]["volume"], 1);
  EXPECT_EQ(extent["low"], Json({0, 0, 0}));
}

// With a number of levels, `refine` lists the goals that extract() planned.
TEST(Report, PlannedLevels) {
  FullReport full;
  full.context.options.levels = 2;
  const Json parameters = full.json()["parameters"];
  EXPECT_EQ(parameters["levels"], 2);
  ASSERT_EQ(parameters["refine"].size(), 2u);
  EXPECT_EQ(parameters["refine"][0][1]["bound"], 3);
}

TEST(Report, MissingValuesAreNull) {
  FullReport full;
  full.report.levels[0].metrics.reset();
  full.report.levels[0].measured.reset();
  const Json level = full.json()["levels"][0];
  EXPECT_TRUE(level["metrics"].is_null());
  EXPECT_TRUE(level["measured"].is_null());
}

TEST(Report, RoundingIsInTheUnitsOfTheMesh) {
  FullReport full;
  full.context.options.space = Space::voxel;
  full.context.volume.grid.spacing = {1, 4, 2};
  const std::string text =
      levels_manifest({full.context.files[1]}, {level_json(full.report.levels[1], 1)});
  EXPECT_EQ(full.json()["files"][1]["largest_rounding"], 0.5);
  EXPECT_EQ(Json::parse(text)["levels"][0]["largest_rounding"], 0.5);
}

TEST(Report, ViolatedDefaultBoundIsNoFailure) {
  FullReport full;
  LevelReport& level = full.report.levels[0];
  level.constraints.clear();
  level.constraints.push_back(
      result_of(Quantity::max_distance, 3, true, 4, false, "max-vertices comes first"));
  EXPECT_TRUE(level.all_satisfied());
  const Json constraint = full.json()["levels"][0]["constraints"][0];
  EXPECT_EQ(constraint["satisfied"], false);
  EXPECT_EQ(constraint["default"], true);
  level.constraints[0].constraint.is_default = false;
  EXPECT_FALSE(level.all_satisfied());
}

TEST(Report, PathsCanHaveBytesThatAreNotUtf8) {
  FullReport full;
  full.context.files[0].path = "a\xff.glb";
  EXPECT_NE(to_json(full.report, full.context).find("a\uFFFD.glb"), std::string::npos);
}

TEST(LevelFacts, RoundTripThroughTheReportAndEachLevel) {
  const FullReport full;
  const std::vector<LevelFacts> of_report =
      facts_of_levels(to_json(full.report, full.context), "r.json");
  ASSERT_EQ(of_report.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const std::string text = level_json(full.report.levels[k], k);
    EXPECT_EQ(text.find("seconds"), std::string::npos);  // the same input gives the same text
    EXPECT_EQ(text.find('\n'), std::string::npos);
    const auto of_level = facts_of_level(text, "a.glb");
    ASSERT_TRUE(of_level);
    for (const LevelFacts& facts : {*of_level, of_report[k]}) {
      EXPECT_EQ(facts.vertices, 10 + k);
      EXPECT_EQ(facts.topology.euler_characteristic, 2);
      EXPECT_EQ(facts.quality.aspect_median, 0.5);
      EXPECT_EQ(facts.metrics[0]->maximum, 2.5);
    }
  }
  EXPECT_FALSE(facts_of_level("null", "a.glb"));
  EXPECT_FALSE(facts_of_level("{\"metrics\":null}", "a.glb")->metrics[0]);
}

// JSON has no infinity; it is written as null.
TEST(LevelFacts, InfiniteMetricsRoundTrip) {
  FullReport full;
  full.report.levels[0].metrics.emplace()[2] = {std::numeric_limits<double>::infinity(), 1.5};
  const auto facts = facts_of_level(level_json(full.report.levels[0], 0), "a.glb");
  EXPECT_EQ(facts->metrics[2]->maximum, std::numeric_limits<double>::infinity());
  EXPECT_EQ(facts->metrics[2]->mean, 1.5);
  EXPECT_TRUE(Json::parse(to_json("a.glb", {*facts},
                                  true))["levels"][0]["metrics"]["area-curvature"]["maximum"]
                  .is_null());
}

TEST(LevelFacts, CountsAreWholeNumbers) {
  for (const char* text : {R"({"vertices":-1})", R"({"triangles":1.5})", R"({"components":true})",
                           R"({"genus":0.5})", R"({"quality":{"aspect_ratio":{"minimum":true}}})",
                           R"({"metrics":{"max-distance":{"maximum":"far"}}})"})
    EXPECT_THROW(facts_of_level(text, "a.glb"), Error) << text;
  EXPECT_EQ(
      facts_of_level(R"({"euler_characteristic":-4})", "a.glb")->topology.euler_characteristic, -4);
}

TEST(LevelFacts, AreReadFromAManifest) {
  const FullReport full;
  const std::string text =
      levels_manifest({{"x/a-0.glb", {0}, 5, true, 0}, {"x/a-1.glb", {1}, 6, true, 0}},
                      {level_json(full.report.levels[0], 0), level_json(full.report.levels[1], 1)});
  EXPECT_EQ(Json::parse(text)["levels"][1]["file"], "a-1.glb");
  EXPECT_EQ(facts_of_levels(text, "a.json")[1].triangles, 21U);
}

TEST(LevelFacts, BadJsonIsAnError) {
  for (const char* text :
       {"", "{", "[]", "{}", R"({"schema":"isoatlas-report-1"})",
        R"({"schema":"isoatlas-report-3"})", R"({"schema":"isoatlas-report-3","levels":[]})",
        R"({"schema":"isoatlas-report-3","levels":[{"vertices":"x"}]})",
        R"({"schema":"isoatlas-report-3","levels":[7]})"})
    EXPECT_THROW(facts_of_levels(text, "r.json"), Error) << text;
  EXPECT_THROW(facts_of_level("{", "r.json"), Error);
}

}  // namespace
}  // namespace isoatlas::detail
