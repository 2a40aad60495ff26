// SPDX-License-Identifier: Apache-2.0
#include "outputs/mesh_outputs.h"

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "isoatlas/error.h"
#include "support/file_test_support.h"

namespace isoatlas::detail {
namespace {

namespace fs = std::filesystem;
using test::TempFolder;

// A tetrahedron, and the same with one face split into three triangles.
Hierarchy two_levels() {
  Hierarchy hierarchy;
  hierarchy.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0.5, 0.5}};
  hierarchy.levels.push_back({4, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}, {}, {}});
  hierarchy.levels.push_back(
      {5, {{0, 2, 1}, {0, 1, 3}, {2, 0, 3}, {1, 2, 4}, {2, 3, 4}, {3, 1, 4}}, {}, {}});
  return hierarchy;
}

HierarchyFileInfo two_infos() {
  HierarchyFileInfo info;
  info.levels = {R"({"level":0})", R"({"level":1})"};
  return info;
}

const HierarchyFileInfo kInfo = two_infos();

// Writes to a folder; returns the levels of each file by its name.
std::map<std::string, std::vector<std::size_t>> written(const TempFolder& folder,
                                                        const std::string& name,
                                                        bool glb_per_level = false) {
  const MeshOutputs meshes(folder / name, glb_per_level);
  meshes.check(2, folder / "volume", {});
  OutputFiles outputs;
  std::map<std::string, std::vector<std::size_t>> files;
  for (const ReportFile& file : meshes.write(two_levels(), kInfo, outputs, nullptr))
    files[fs::path(file.path).lexically_relative(folder.path()).string()] = file.levels;
  outputs.commit();
  for (const auto& [file, levels] : files) EXPECT_TRUE(fs::is_regular_file(folder / file)) << file;
  return files;
}

using Files = std::map<std::string, std::vector<std::size_t>>;

TEST(MeshOutputs, FilesHaveTheirLevels) {
  const TempFolder folder;
  EXPECT_EQ(written(folder, "a.ply"), (Files{{"a.ply", {1}}}));
  EXPECT_EQ(read_mesh(folder / "a.ply").triangles.size(), 6U);
  EXPECT_EQ(written(folder, "b{level}.stl"), (Files{{"b0.stl", {0}}, {"b1.stl", {1}}}));
  EXPECT_EQ(read_mesh(folder / "b0.stl").triangles.size(), 4U);
  EXPECT_EQ(written(folder, "c.glb"), (Files{{"c.glb", {0, 1}}}));
  EXPECT_EQ(written(folder, "d.vtm"),
            (Files{{"d.vtm", {0, 1}}, {"d/d_0.vtp", {0}}, {"d/d_1.vtp", {1}}}));
  EXPECT_EQ(written(folder, "e-{level}.glb"), (Files{{"e-0.glb", {0}}, {"e-1.glb", {1}}}));
  EXPECT_EQ(written(folder, "f.glb", true),
            (Files{{"f.glb", {0, 1}}, {"f-0.glb", {0}}, {"f-1.glb", {1}}}));
  EXPECT_TRUE(fs::is_regular_file(folder / "f.json"));
  EXPECT_EQ(read_hierarchy(folder / "f-0.glb").hierarchy.positions.size(), 4U);
  EXPECT_EQ(read_hierarchy(folder / "f-1.glb").info.levels,
            std::vector<std::string>{R"({"level":1})"});
  EXPECT_EQ(folder.file_count(), 12U);
}

TEST(MeshOutputs, LinksAreFollowed) {
  const TempFolder folder;
  fs::create_directory(folder / "elsewhere");
  test::write_bytes(folder / "elsewhere/b.vtm", "old");
  fs::create_symlink("elsewhere/b.vtm", folder / "a.vtm");
  const MeshOutputs meshes(folder / "a.vtm", false);
  meshes.check(2, folder / "volume", {});
  {
    OutputFiles outputs;
    meshes.write(two_levels(), kInfo, outputs, nullptr);
    outputs.commit();
  }
  EXPECT_TRUE(fs::is_symlink(folder / "a.vtm"));
  EXPECT_EQ(read_hierarchy(folder / "elsewhere/b.vtm").hierarchy.levels.size(), 2U);
  EXPECT_TRUE(fs::exists(folder / "elsewhere/b/b_1.vtp"));
  EXPECT_EQ(folder.file_count(), 2U);
}

TEST(MeshOutputs, ListsAllFiles) {
  using Paths = std::vector<fs::path>;
  EXPECT_EQ(MeshOutputs("a.ply", false).paths(3), (Paths{"a.ply"}));
  EXPECT_EQ(MeshOutputs("a-{level}.ply", false).paths(3), (Paths{"a-0.ply", "a-1.ply", "a-2.ply"}));
  EXPECT_EQ(MeshOutputs("a.glb", true).paths(2), (Paths{"a.glb", "a-0.glb", "a-1.glb", "a.json"}));
  const Paths vtm = MeshOutputs("a.vtm", false).paths(2);
  ASSERT_EQ(vtm.size(), 3u);
  EXPECT_EQ(vtm[0], "a.vtm");
  EXPECT_EQ(vtm[2].filename(), "a_1.vtp");
}

}  // namespace
}  // namespace isoatlas::detail
