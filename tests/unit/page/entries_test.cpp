// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>

#include "isoatlas/error.h"
#include "isoatlas/extract.h"
#include "isoatlas/io.h"
#include "page/page.h"
#include "report/report.h"
#include "support/exact_volume.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class PageEntries : public ::testing::Test {
 protected:
  PageEntries() {
    fs::create_directories(folder_);
    volume_ = test::exact_volume({24, 24, 24}, test::torus({11.3, 11.6, 11.4}, 6.5, 2.5));
    options_.refine = {{{Quantity::max_distance, 0.5}}};
    extraction_ = extract(volume_, options_);
  }
  ~PageEntries() override { fs::remove_all(folder_); }

  ReportContext context() const {
    ReportContext out;
    out.volume.path = "torus.nrrd";
    out.command = "isoatlas extract torus.nrrd";
    out.volume.grid = volume_.view.grid;
    out.volume.grid.unit = LengthUnit::millimetre;
    out.options = options_;
    return out;
  }
  HierarchyFileInfo info() const {
    HierarchyFileInfo out;
    out.mesh.space = "LPS";
    for (std::size_t k = 0; k < extraction_.report.levels.size(); ++k)
      out.levels.push_back(level_json(extraction_.report.levels[k], k));
    return out;
  }

  fs::path folder_ = fs::temp_directory_path() / ("isoatlas-page-" + std::to_string(::getpid()));
  Volume volume_;
  ExtractOptions options_ = test::coarse_options();
  Extraction extraction_;
};

void expect_error(ErrorCode code, const std::string& fragment, const std::function<void()>& work) {
  try {
    work();
    FAIL() << "no error: " << fragment;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_NE(std::string(error.what()).find(fragment), std::string::npos) << error.what();
  }
}

TEST_F(PageEntries, ContainTheFactsOfAReport) {
  const auto cubes = marching_cubes_quality(volume_, 0);
  ASSERT_TRUE(cubes);
  const PageEntry entry = entry_of_report(to_json(extraction_.report, context()), "r.json",
                                          extraction_.hierarchy, cubes);
  const json facts = json::parse(entry.facts);
  EXPECT_EQ(facts["title"], "torus.nrrd at 0");
  EXPECT_EQ(facts["unit"], "mm");
  EXPECT_EQ(facts["command"], "isoatlas extract torus.nrrd");
  EXPECT_EQ(facts["levels"].size(), 2u);
  EXPECT_EQ(facts["levels"][1]["genus"], 1);
  EXPECT_EQ(facts["levels"][1]["extent"]["volume"], *extraction_.finest().extent.volume);
  EXPECT_EQ(facts["levels"][1]["extent"]["largest"].size(), 1u);
  EXPECT_EQ(facts["reference"]["genus"], 1);
  EXPECT_EQ(facts["marching_cubes"]["triangles"], cubes->triangles);
  EXPECT_FALSE(facts["levels"][1].contains("at_limit"));
}

TEST_F(PageEntries, RefuseAReportAboutAnotherMesh) {
  const std::string report = to_json(extraction_.report, context());
  Hierarchy other = extraction_.hierarchy;
  other.levels[1].triangles.pop_back();
  expect_error(ErrorCode::bad_file, "r.json: is about another mesh: level 1",
               [&] { entry_of_report(report, "r.json", other, {}); });
  expect_error(ErrorCode::bad_file, "r.json: is not a report",
               [&] { entry_of_report("{}", "r.json", other, {}); });
  expect_error(ErrorCode::bad_file, "r.json: is not a report",
               [&] { entry_of_report("no json", "r.json", other, {}); });
  json broken = json::parse(report);
  broken.erase("levels");
  expect_error(ErrorCode::bad_file, "r.json: has no 'levels'",
               [&] { entry_of_report(broken.dump(), "r.json", other, {}); });
  broken = json::parse(report);
  broken["levels"][0]["vertices"] = "many";
  expect_error(ErrorCode::bad_file, "r.json: is about another mesh: level 0",
               [&] { entry_of_report(broken.dump(), "r.json", extraction_.hierarchy, {}); });
  broken = json::parse(report);
  broken["surface"]["isovalue"] = "high";
  expect_error(ErrorCode::bad_file, "r.json: a key",
               [&] { entry_of_report(broken.dump(), "r.json", extraction_.hierarchy, {}); });
}

TEST_F(PageEntries, OfFilesContainTheirFactsAndCounts) {
  write_hierarchy(extraction_.hierarchy, folder_ / "a.glb", info());
  const PageEntry levels = entry_of_file(folder_ / "a.glb");
  EXPECT_EQ(levels.hierarchy.levels.size(), 2u);
  json facts = json::parse(levels.facts);
  EXPECT_EQ(facts["title"], "a.glb");
  EXPECT_TRUE(facts["command"].is_null());
  EXPECT_TRUE(facts["levels"][1]["certificate"]["passed"]);
  EXPECT_FALSE(levels.hierarchy.levels[1].distance.empty());

  write_mesh(extraction_.mesh(), folder_ / "a.ply");
  const PageEntry mesh = entry_of_file(folder_ / "a.ply");
  facts = json::parse(mesh.facts);
  EXPECT_EQ(facts["levels"].size(), 1u);
  EXPECT_EQ(facts["levels"][0]["genus"], 1);
  EXPECT_EQ(facts["levels"][0]["triangles"], extraction_.finest().triangles);
  EXPECT_EQ(facts["levels"][0]["extent"]["volume"], *extraction_.finest().extent.volume);
  EXPECT_FALSE(facts["levels"][0].contains("certificate"));
  EXPECT_EQ(facts["unit"], "units") << "the file does not state its space";
}

// Facts that do not agree with the triangles are not shown, and neither is their certificate.
TEST_F(PageEntries, OfFilesWithWrongFactsAreCounted) {
  HierarchyFileInfo wrong = info();
  json level = json::parse(wrong.levels[1]);
  level["genus"] = 7;
  wrong.levels[1] = level.dump();
  write_hierarchy(extraction_.hierarchy, folder_ / "a.glb", wrong);
  const json facts = json::parse(entry_of_file(folder_ / "a.glb").facts);
  EXPECT_TRUE(facts["levels"][0].contains("certificate"));
  EXPECT_FALSE(facts["levels"][1].contains("certificate"));
  EXPECT_EQ(facts["levels"][1]["genus"], 1);
}

// An array in Python is such a volume.
TEST_F(PageEntries, OfAReportAboutAVolumeInMemory) {
  ReportContext report_context = context();
  report_context.volume.path.clear();
  report_context.volume.grid.unit = LengthUnit::unknown;
  write_hierarchy(extraction_.hierarchy, folder_ / "a.glb", info());
  report_context.files = {{"a.glb", {0, 1}, 1}};
  write_text_file(to_json(extraction_.report, report_context), folder_ / "r.json");
  const json facts = json::parse(entry_of_file(folder_ / "r.json").facts);
  EXPECT_EQ(facts["title"], "r.json at 0");
  EXPECT_EQ(facts["unit"], "units");
  EXPECT_TRUE(facts["marching_cubes"].is_null());
}

// Files that a report names are also found in its folder.
TEST_F(PageEntries, FindTheMeshesOfAReport) {
  ReportContext report_context = context();
  const auto report_of = [&](std::vector<ReportFile> files) {
    report_context.files = std::move(files);
    write_text_file(to_json(extraction_.report, report_context), folder_ / "r.json");
    return entry_of_file(folder_ / "r.json");
  };
  write_hierarchy(extraction_.hierarchy, folder_ / "a.glb", info());
  EXPECT_EQ(report_of({{"elsewhere/a.glb", {0, 1}, 1}}).hierarchy.levels.size(), 2u);
  write_mesh(extraction_.hierarchy.mesh(0), folder_ / "a-0.ply");
  write_mesh(extraction_.hierarchy.mesh(1), folder_ / "a-1.ply");
  const PageEntry both = report_of({{"a-0.ply", {0}, 1}, {"a-1.ply", {1}, 1}});
  EXPECT_EQ(both.hierarchy.levels.size(), 2u);
  EXPECT_TRUE(both.hierarchy.levels[0].own_positions.empty()) << "nested: the positions are shared";
  const PageEntry finest = report_of({{"a-1.ply", {1}, 1}});
  EXPECT_EQ(finest.hierarchy.levels.size(), 1u);
  EXPECT_EQ(json::parse(finest.facts)["levels"][0]["level"], 1);
  write_mesh(extraction_.hierarchy.mesh(0), folder_ / "a-0.stl");
  write_mesh(extraction_.hierarchy.mesh(1), folder_ / "a-1.stl");
  EXPECT_TRUE(json::parse(both.facts)["nested"]);
  EXPECT_FALSE(json::parse(report_of({{"a-0.stl", {0}, 1}, {"a-1.stl", {1}, 1}}).facts)["nested"]);
  expect_error(ErrorCode::bad_file, "names no file", [&] { report_of({}); });
  expect_error(ErrorCode::bad_file, "gone.ply", [&] { report_of({{"gone.ply", {1}, 1}}); });
}

TEST(PageMarchingCubes, HasOnlyTheKeptComponents) {
  const Volume volume = test::exact_volume(
      {32, 12, 12},
      test::unite(test::sphere({5.4, 5.5, 5.6}, 4), test::sphere({20.4, 5.5, 5.6}, 3)));
  ExtractOptions options = test::coarse_options();
  options.components.keep_largest = 1;
  options.space = Space::ras;
  const ExtractReport report = extract(volume, options).report;
  const Volume alone = test::exact_volume({32, 12, 12}, test::sphere({5.4, 5.5, 5.6}, 4));
  const auto both = marching_cubes_quality(volume, 0), wanted = marching_cubes_quality(alone, 0);
  ASSERT_EQ(report.kept.size(), 1u);
  const auto kept = marching_cubes_quality(
      volume, 0, to_index({report.kept[0].position}, volume.view.grid, options.space));
  ASSERT_TRUE(both && wanted && kept);
  EXPECT_EQ(kept->triangles, wanted->triangles);
  EXPECT_LT(kept->triangles, both->triangles);
}

TEST(PageMarchingCubes, IsAbsentWithoutASurface) {
  Volume volume = test::exact_volume({8, 8, 8}, test::sphere({3.4, 3.5, 3.6}, 2));
  EXPECT_FALSE(marching_cubes_quality(volume, 1e9)) << "no surface";
  const auto quality = marching_cubes_quality(volume, 0);
  ASSERT_TRUE(quality);
  EXPECT_GT(quality->triangles, 50u);
  EXPECT_EQ(std::accumulate(quality->aspect_histogram.begin(), quality->aspect_histogram.end(),
                            std::size_t{0}),
            quality->triangles);
}

}  // namespace
}  // namespace isoatlas::detail
