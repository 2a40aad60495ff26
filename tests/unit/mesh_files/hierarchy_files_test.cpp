// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "core/vector_math.h"
#include "isoatlas/io.h"
#include "support/file_test_support.h"
#include "support/mesh_counts.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;

constexpr std::array kFormats{".glb", ".vtm"};

// Splits every triangle into four. New vertices are on the unit sphere, after the old vertices.
std::vector<Triangle> subdivided(const std::vector<Triangle>& triangles,
                                 std::vector<Vec3>& positions) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [found, is_new] = middles.try_emplace({std::min(a, b), std::max(a, b)},
                                                     static_cast<std::uint32_t>(positions.size()));
    if (is_new) {
      const Vec3 p{positions[a].x + positions[b].x, positions[a].y + positions[b].y,
                   positions[a].z + positions[b].z};
      const double length = std::hypot(p.x, p.y, p.z);
      positions.push_back({p.x / length, p.y / length, p.z / length});
    }
    return found->second;
  };
  std::vector<Triangle> result;
  for (const Triangle& t : triangles) {
    const std::uint32_t ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
    result.insert(result.end(), {{t[0], ab, ca}, {t[1], bc, ab}, {t[2], ca, bc}, {ab, bc, ca}});
  }
  return result;
}

struct Shape {
  bool is_open = false, is_balanced = false;
  Vec3 middle{1.5, -0.3, 0.7};
  double scale = 10;
};

// A sphere or its upper half, in three nested levels.
Hierarchy sphere(const Shape& shape) {
  Hierarchy hierarchy;
  std::vector<Vec3>& positions = hierarchy.positions;
  positions = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
  std::vector<Triangle> triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  if (!shape.is_open) {
    positions.push_back({0, 0, -1});
    triangles.insert(triangles.end(), {{1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}});
  }
  for (int level = 0; level < 3; ++level) {
    if (level > 0) triangles = subdivided(triangles, positions);
    hierarchy.levels.push_back({static_cast<std::uint32_t>(positions.size()), triangles, {}, {}});
    for (std::size_t v = 0; v < positions.size() && !(shape.is_open && level == 0);
         ++v)  // level 0 of the open shapes has no distances
      hierarchy.levels.back().distance.push_back(0.1f * static_cast<float>(v) /
                                                 static_cast<float>(level + 1));
  }
  for (Vec3& p : positions)
    p = {shape.middle.x + shape.scale * p.x, shape.middle.y + shape.scale * p.y,
         shape.middle.z + shape.scale * p.z};
  hierarchy.parent.assign(positions.size(), 0);
  for (std::size_t k = 0; shape.is_balanced && k < 3; ++k) {
    Hierarchy::Level& level = hierarchy.levels[k];
    for (std::uint32_t v = 0; v < level.vertex_count; ++v) {
      Vec3 p = positions[v];
      p.z += 0.1 * shape.scale / static_cast<double>(k + 1);
      level.own_positions.push_back(p);
    }
  }
  return hierarchy;
}

HierarchyFileInfo info_of(const Shape& shape) {
  return {.mesh = {.space = "LPS", .comment = "isoatlas 0.1.0"},
          .placement = shape.is_balanced ? Placement::balanced : Placement::surface,
          .levels = {R"({"level":0,"x":[1,2.5]})", R"({"level":1,"t":"a \"b\" <&>"})",
                     R"({"level":2})"}};
}

std::vector<Shape> shapes() {
  std::vector<Shape> result;
  for (const bool is_open : {false, true})
    for (const bool is_balanced : {false, true})
      result.push_back({.is_open = is_open, .is_balanced = is_balanced});
  return result;
}

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

double largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double largest = a.size() == b.size() ? 0 : 1e300;
  for (std::size_t v = 0; v < std::min(a.size(), b.size()); ++v)
    largest = std::max(largest, std::hypot(a[v].x - b[v].x, a[v].y - b[v].y, a[v].z - b[v].z));
  return largest;
}

void expect_same(const HierarchyFile& read, const Hierarchy& hierarchy,
                 const HierarchyFileInfo& info, double rounding) {
  ASSERT_EQ(read.hierarchy.levels.size(), hierarchy.levels.size());
  for (std::size_t k = 0; k < hierarchy.levels.size(); ++k) {
    SCOPED_TRACE(k);
    EXPECT_EQ(read.hierarchy.levels[k].vertex_count, hierarchy.levels[k].vertex_count);
    EXPECT_EQ(read.hierarchy.levels[k].triangles, hierarchy.levels[k].triangles);
    EXPECT_EQ(read.hierarchy.levels[k].distance, hierarchy.levels[k].distance);
    EXPECT_LE(largest_distance(read.hierarchy.mesh(k).positions, hierarchy.mesh(k).positions),
              rounding);
    const MeshCounts counts = count_mesh(read.hierarchy.mesh(k));
    EXPECT_EQ(counts.fault, "");
    EXPECT_EQ(counts.components, count_mesh(hierarchy.mesh(k)).components);
    EXPECT_EQ(nlohmann::json::parse(read.info.levels[k]), nlohmann::json::parse(info.levels[k]));
    // Nested levels stay nested with equal bits, so no level needs positions of its own.
    EXPECT_TRUE(info.placement == Placement::balanced ||
                read.hierarchy.levels[k].own_positions.empty());
  }
  EXPECT_EQ(read.info.mesh.space, info.mesh.space);
  EXPECT_EQ(read.info.mesh.comment, info.mesh.comment);
  EXPECT_EQ(read.info.placement, info.placement);
}

TEST(HierarchyFiles, RoundTrip) {
  for (const Shape& shape : shapes()) {
    const Hierarchy hierarchy = sphere(shape);
    const HierarchyFileInfo info = info_of(shape);
    for (const char* extension : kFormats) {
      SCOPED_TRACE(std::string(extension) + (shape.is_open ? " open" : " closed") +
                   (shape.is_balanced ? " balanced" : ""));
      const TempFolder folder;
      const fs::path path = folder / (std::string("levels") + extension);
      check_hierarchy_path(path, 3);
      EXPECT_EQ(folder.file_count(), 0U);
      const StoredPositions stored = write_hierarchy(hierarchy, path, info);
      EXPECT_EQ(stored.single_precision, std::string(extension) == ".glb");
      EXPECT_LT(stored.largest_rounding, 1e-6);
      EXPECT_EQ(stored.largest_rounding > 0, stored.single_precision);
      EXPECT_EQ(stored.largest_rounding, rounding_of_hierarchy_file(hierarchy, path));
      for (const fs::path& file : files_of_hierarchy(path, 3))
        EXPECT_TRUE(fs::is_regular_file(file)) << file;
      expect_same(read_hierarchy(path), hierarchy, info, stored.largest_rounding);
    }
  }
}

TEST(HierarchyFiles, VtmKeepsEveryBitAndItsPiecesAreMeshes) {
  const TempFolder folder;
  const Hierarchy hierarchy = sphere({.is_open = true});
  write_hierarchy(hierarchy, folder / "a & b.vtm", info_of({}));
  EXPECT_TRUE(
      same_bits(read_hierarchy(folder / "a & b.vtm").hierarchy.positions, hierarchy.positions));
  for (std::size_t k = 0; k < 3; ++k) {
    const TriangleMesh mesh = read_mesh(folder / ("a & b/a & b_" + std::to_string(k) + ".vtp"));
    EXPECT_EQ(mesh.triangles, hierarchy.levels[k].triangles);
    EXPECT_TRUE(same_bits(mesh.positions, hierarchy.mesh(k).positions));
  }
}

TEST(HierarchyFiles, VtmReplacesItsOwnFilesInAFolderAndNoOthers) {
  const TempFolder folder;
  fs::create_directory(folder / "a");
  write_bytes(folder / "a/a_0.vtp", "old");
  write_bytes(folder / "a/a_7.vtp", "old");
  write_bytes(folder / "a/notes.txt", "mine");
  write_hierarchy(sphere({}), folder / "a.vtm");
  EXPECT_EQ(read_hierarchy(folder / "a.vtm").hierarchy.levels.size(), 3U);
  EXPECT_EQ(read_bytes(folder / "a/a_7.vtp"), "old");
  EXPECT_EQ(read_bytes(folder / "a/notes.txt"), "mine");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "a"), {}), 5);
}

TEST(HierarchyFiles, SameLevelsSameBytes) {
  const TempFolder folder;
  write_hierarchy(sphere({}), folder / "a.glb", info_of({}));
  write_hierarchy(sphere({}), folder / "b.glb", info_of({}));
  EXPECT_EQ(read_bytes(folder / "a.glb"), read_bytes(folder / "b.glb"));
}

tinygltf::Model load(const fs::path& path) {
  tinygltf::TinyGLTF loader;
  tinygltf::Model model;
  std::string error, warning;
  EXPECT_TRUE(loader.LoadBinaryFromFile(&model, &error, &warning, path.string())) << error;
  EXPECT_EQ(error + warning, "");
  return model;
}

TEST(HierarchyFiles, GlbHasTheLevelsAsLevelsOfDetail) {
  for (const Shape& shape : shapes()) {
    const TempFolder folder;
    const Hierarchy hierarchy = sphere(shape);
    write_hierarchy(hierarchy, folder / "a.glb", info_of(shape));
    const tinygltf::Model model = load(folder / "a.glb");
    EXPECT_EQ(model.asset.version, "2.0");
    EXPECT_EQ(model.extensionsUsed,
              shape.is_open ? std::vector<std::string>{"MSFT_lod"}
                            : (std::vector<std::string>{"EXT_mesh_manifold", "MSFT_lod"}));
    EXPECT_TRUE(
        model.extensionsRequired.empty());  // programs without the extension show the finest level
    ASSERT_EQ(model.scenes.size(), 1U);
    EXPECT_EQ(model.scenes[0].nodes, std::vector<int>{0});
    const tinygltf::Value& ids = model.nodes[0].extensions.at("MSFT_lod").Get("ids");
    ASSERT_EQ(ids.ArrayLen(), 2U);
    EXPECT_EQ(model.nodes[0].extras.Get("MSFT_screencoverage").ArrayLen(), 3U);
    std::set<int> position_views;
    for (int i = 0; i < 3; ++i) {  // finest first
      const std::size_t k = 2 - i;
      const tinygltf::Node& node = model.nodes[i == 0 ? 0 : ids.Get(i - 1).GetNumberAsInt()];
      EXPECT_EQ(node.name, "level " + std::to_string(k));
      EXPECT_TRUE(node.translation.empty());
      const tinygltf::Mesh& mesh = model.meshes[node.mesh];
      EXPECT_EQ(mesh.extras.Get("isoatlas").Get("level").GetNumberAsInt(), static_cast<int>(k));
      ASSERT_EQ(mesh.primitives.size(), 1U);
      const tinygltf::Accessor& positions =
          model.accessors[mesh.primitives[0].attributes.at("POSITION")];
      const tinygltf::Accessor& normals =
          model.accessors[mesh.primitives[0].attributes.at("NORMAL")];
      const tinygltf::Accessor& indices = model.accessors[mesh.primitives[0].indices];
      EXPECT_EQ(positions.count, hierarchy.levels[k].vertex_count);
      EXPECT_EQ(normals.count, positions.count);
      EXPECT_EQ(indices.count, 3 * hierarchy.levels[k].triangles.size());
      EXPECT_EQ(positions.byteOffset, 0U);
      EXPECT_EQ(positions.minValues.size() + positions.maxValues.size(), 6U);
      EXPECT_EQ(model.bufferViews[positions.bufferView].byteStride, 12U);
      position_views.insert(positions.bufferView);
      // The normals of the sphere, except at its boundary.
      const tinygltf::BufferView& view = model.bufferViews[normals.bufferView];
      for (std::size_t v = 0; !shape.is_open && !shape.is_balanced && v < normals.count; ++v) {
        float n[3];
        std::memcpy(n, model.buffers[0].data.data() + view.byteOffset + 12 * v, 12);
        const Vec3& p = hierarchy.positions[v];
        const double along = n[0] * (p.x - shape.middle.x) + n[1] * (p.y - shape.middle.y) +
                             n[2] * (p.z - shape.middle.z);
        EXPECT_GT(along / shape.scale, 0.99);
        EXPECT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-6);
      }
    }
    EXPECT_EQ(position_views.size(), shape.is_balanced ? 3U : 1U);
  }
}

// The rules of the extension: the manifold primitive has only positions, from the same accessor,
// and no material.
TEST(HierarchyFiles, ClosedLevelsOfAGlbAreMarkedAsManifolds) {
  Hierarchy hierarchy = sphere({});
  hierarchy.levels[1].triangles.pop_back();  // open; the other levels are closed
  const TempFolder folder;
  write_hierarchy(hierarchy, folder / "a.glb");
  const tinygltf::Model model = load(folder / "a.glb");
  ASSERT_EQ(model.meshes.size(), 3U);
  for (const tinygltf::Mesh& mesh : model.meshes) {
    SCOPED_TRACE(mesh.name);
    const auto found = mesh.extensions.find("EXT_mesh_manifold");
    ASSERT_EQ(found != mesh.extensions.end(), mesh.name != "level 1");
    if (found == mesh.extensions.end()) continue;
    const tinygltf::Value& manifold = found->second.Get("manifoldPrimitive");
    EXPECT_EQ(found->second.Keys(),
              std::vector<std::string>{"manifoldPrimitive"});  // and no list of merged vertices
    EXPECT_EQ(manifold.Keys(), (std::vector<std::string>{"attributes", "indices", "mode"}));
    EXPECT_EQ(manifold.Get("attributes").Keys(), std::vector<std::string>{"POSITION"});
    EXPECT_EQ(manifold.Get("attributes").Get("POSITION").GetNumberAsInt(),
              mesh.primitives[0].attributes.at("POSITION"));
    EXPECT_EQ(manifold.Get("indices").GetNumberAsInt(), mesh.primitives[0].indices);
    EXPECT_EQ(manifold.Get("mode").GetNumberAsInt(), 4);
  }
}

TEST(HierarchyFiles, GlbOfOneOpenLevelNeedsNoExtension) {
  const TempFolder folder;
  Hierarchy hierarchy = sphere({.is_open = true});
  hierarchy.levels.resize(1);
  write_hierarchy(hierarchy, folder / "a.glb");
  const tinygltf::Model model = load(folder / "a.glb");
  EXPECT_TRUE(model.extensionsUsed.empty());
  EXPECT_EQ(model.nodes.size(), 1U);
  EXPECT_EQ(read_hierarchy(folder / "a.glb").info.levels.size(), 0U);
  EXPECT_EQ(read_hierarchy(folder / "a.glb").hierarchy.positions.size(),
            5U);  // the file has no others
}

TEST(HierarchyFiles, LargeCoordinatesGetATranslation) {
  const TempFolder folder;
  const Shape shape{.middle = {1e6, -3e6 + 1.0 / 3, 12}, .scale = 0.001};
  const Hierarchy hierarchy = sphere(shape);
  const StoredPositions stored = write_hierarchy(hierarchy, folder / "a.glb", info_of(shape));
  EXPECT_EQ(stored.largest_rounding, rounding_of_hierarchy_file(hierarchy, folder / "a.glb"));
  EXPECT_LT(stored.largest_rounding,
            2e-8);  // the translation is float too, so up to 0.125 remains in the positions
  const tinygltf::Model model = load(folder / "a.glb");
  for (const tinygltf::Node& node : model.nodes) {
    ASSERT_EQ(node.translation.size(), 3U);
    for (const double t : node.translation)
      EXPECT_EQ(t, static_cast<double>(static_cast<float>(t)));
    EXPECT_EQ(node.translation[0], 1e6);
  }
  expect_same(read_hierarchy(folder / "a.glb"), hierarchy, info_of(shape), stored.largest_rounding);
  expect_error(ErrorCode::bad_file, "float coordinates", folder / "a.stl",
               [&] { write_mesh(hierarchy.mesh(2), folder / "a.stl"); });
  EXPECT_FALSE(fs::exists(folder / "a.stl"));
}

TEST(HierarchyFiles, VerticesThatWouldBecomeEqualAsFloatsAreRefused) {
  const TempFolder folder;
  Hierarchy hierarchy = sphere({});
  hierarchy.positions[40] = hierarchy.positions[20];
  hierarchy.positions[40].x += 1e-9;
  write_bytes(folder / "a.glb", "old");
  expect_error(ErrorCode::bad_file, "vertices 20 and 40 of level 2 would become one",
               folder / "a.glb", [&] { write_hierarchy(hierarchy, folder / "a.glb"); });
  EXPECT_EQ(read_bytes(folder / "a.glb"), "old");
  EXPECT_EQ(folder.file_count(), 1U);
  write_hierarchy(hierarchy, folder / "a.vtm");  // doubles keep them apart
  // Vertices that are equal from the start are allowed: the file merges nothing, and the indices
  // keep them apart.
  hierarchy.positions[40] = hierarchy.positions[20];
  write_hierarchy(hierarchy, folder / "a.glb");
  // A mesh with details smaller than the float spacing, in which no two vertices become equal.
  Hierarchy flat = sphere({.middle = {0, 0, 0}, .scale = 1e-6});
  for (std::size_t v = 0; v < flat.positions.size(); ++v) flat.positions[v].z += v < 6 ? 0 : 100;
  flat.levels.erase(flat.levels.begin(), flat.levels.begin() + 2);
  flat.levels[0].triangles.resize(1);
  flat.levels[0].triangles[0] = {10, 11, 12};
  expect_error(ErrorCode::bad_file, "float coordinates", folder / "b.glb",
               [&] { write_hierarchy(flat, folder / "b.glb"); });
  hierarchy.positions[3].x = 1e300;
  expect_error(ErrorCode::bad_file, "out of the range", folder / "b.glb",
               [&] { write_hierarchy(hierarchy, folder / "b.glb"); });
  EXPECT_FALSE(fs::exists(folder / "b.glb"));
}

TEST(HierarchyFiles, WrongLevelsAreNotWritten) {
  for (const char* extension : kFormats) {
    const TempFolder folder;
    const fs::path path = folder / (std::string("a") + extension);
    const auto refuse = [&](const std::string& fragment, const Hierarchy& hierarchy,
                            const HierarchyFileInfo& info = {}) {
      expect_error(ErrorCode::bad_argument, fragment, path,
                   [&] { write_hierarchy(hierarchy, path, info); });
    };
    Hierarchy hierarchy = sphere({});
    hierarchy.levels.clear();
    refuse("no levels", hierarchy);
    hierarchy = sphere({});
    hierarchy.levels[1].triangles[5][2] = 18;
    refuse("level 1: triangle 5", hierarchy);
    hierarchy = sphere({});
    std::swap(hierarchy.levels[0], hierarchy.levels[1]);
    refuse("level 1: its 6 vertices", hierarchy);
    hierarchy = sphere({});
    hierarchy.levels[2].vertex_count = 1000;
    refuse("level 2", hierarchy);
    hierarchy = sphere({.is_balanced = true});
    hierarchy.levels[1].own_positions.pop_back();
    refuse("level 1", hierarchy);
    hierarchy = sphere({});
    hierarchy.positions[3].y = std::numeric_limits<double>::infinity();
    refuse("vertex 3 is not finite", hierarchy);
    hierarchy = sphere({});
    hierarchy.levels[0].triangles.clear();
    refuse("no triangles", hierarchy);
    hierarchy = sphere({});
    hierarchy.levels[1].distance.pop_back();
    refuse("level 1: there are 17 distances for 18 vertices", hierarchy);
    hierarchy = sphere({});
    hierarchy.levels[1].distance[4] = -0.5F;
    refuse("level 1: the distance of vertex 4", hierarchy);
    refuse("2 JSON texts for 3 levels", sphere({}),
           {.mesh = {}, .placement = {}, .levels = {"{}", "{}"}});
    refuse("level 1: its JSON text is not", sphere({}),
           {.mesh = {}, .placement = {}, .levels = {"{}", "[1]", "{}"}});
    EXPECT_EQ(folder.file_count(), 0U);
  }
}

TEST(HierarchyFiles, PathIsCheckedBeforeTheWork) {
  const TempFolder folder;
  expect_error(ErrorCode::unsupported, ".glb or .vtm", folder / "a.ply",
               [&] { check_hierarchy_path(folder / "a.ply", 1); });
  expect_error(ErrorCode::bad_file, "no folder", folder / "none/a.glb",
               [&] { check_hierarchy_path(folder / "none/a.glb", 1); });
  write_bytes(folder / "file", "x");
  expect_error(ErrorCode::bad_file, "is not a folder", folder / "file.vtm",
               [&] { check_hierarchy_path(folder / "file.vtm", 1); });
  fs::create_directories(folder / "a/a_1.vtp");
  check_hierarchy_path(folder / "a.vtm", 1);
  expect_error(ErrorCode::bad_file, "it is a folder", folder / "a/a_1.vtp",
               [&] { check_hierarchy_path(folder / "a.vtm", 2); });
  EXPECT_TRUE(is_hierarchy_path("A.GLB"));
  EXPECT_FALSE(is_hierarchy_path("a.glb.ply"));
  EXPECT_EQ(files_of_hierarchy("x/a.vtm", 2),
            (std::vector<fs::path>{"x/a.vtm", "x/a/a_0.vtp", "x/a/a_1.vtp"}));
}

TEST(HierarchyFiles, FullDiskIsAnErrorAndLeavesNothing) {
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  for (const char* extension : kFormats) {
    const TempFolder folder;
    const fs::path path = folder / (std::string("a") + extension);
    write_bytes(path, "old");
    {
      const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
      rlimit small = old;
      small.rlim_cur = 1500;  // the first level fits
      ::setrlimit(RLIMIT_FSIZE, &small);
      const Hierarchy hierarchy = sphere({});
      expect_error(ErrorCode::bad_file, "cannot be written",
                   extension == std::string(".glb") ? path : folder / "a/a_",
                   [&] { write_hierarchy(hierarchy, path); });
      ::setrlimit(RLIMIT_FSIZE, &old);
      std::signal(SIGXFSZ, old_handler);
    }
    EXPECT_EQ(read_bytes(path), "old");
    EXPECT_EQ(folder.file_count(), 1U) << extension;
  }
}

// A file that is cut or has one byte changed gives an Error or levels, never a crash; a cut .glb
// always gives an Error.
TEST(HierarchyFiles, DamagedFiles) {
  std::mt19937 random(11);
  const TempFolder folder;
  const fs::path path = folder / "a.glb";
  write_hierarchy(sphere({}), path, info_of({}));
  const std::string whole = read_bytes(path);
  for (int i = 0; i < 500; ++i) {
    write_bytes(path, whole.substr(0, random() % whole.size()));
    EXPECT_THROW(read_hierarchy(path), Error);
    std::string changed = whole;
    // Half of the changes are in the JSON, where they have the most effect.
    changed[random() % (i % 2 == 0 ? whole.size() : 3000)] = static_cast<char>(random());
    write_bytes(path, changed);
    try {
      const HierarchyFile file = read_hierarchy(path);
      for (std::size_t k = 0; k < file.hierarchy.levels.size(); ++k) {
        const TriangleMesh mesh = file.hierarchy.mesh(k);
        for (const Triangle& t : mesh.triangles)
          ASSERT_LT(std::max({t[0], t[1], t[2]}), mesh.positions.size());
      }
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

TEST(HierarchyFiles, InvalidDistancesAreRefused) {
  const TempFolder folder;
  const fs::path path = folder / "a.glb";
  Hierarchy hierarchy = sphere({});
  constexpr float kMark = 0.7109375F;
  hierarchy.levels[1].distance[4] = kMark;
  write_hierarchy(hierarchy, path);
  const std::string bytes = read_bytes(path);
  const auto as_bytes = [](float value) {
    return std::string(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const std::size_t at = bytes.find(as_bytes(kMark));
  ASSERT_NE(at, std::string::npos);
  for (const float bad :
       {-1.0F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    write_bytes(path, std::string(bytes).replace(at, sizeof bad, as_bytes(bad)));
    expect_error(ErrorCode::bad_file, "level 1: the distance of vertex 4", path,
                 [&] { read_hierarchy(path); });
  }
}

TEST(HierarchyFiles, AnyFileWithMeshesIsRead) {
  const TempFolder folder;
  const Hierarchy hierarchy = sphere({});
  write_hierarchy(hierarchy, folder / "a.vtm");
  EXPECT_EQ(read_levels(folder / "a.vtm").hierarchy.levels.size(), 3U);
  write_mesh(hierarchy.mesh(1), folder / "a.ply", {"lps", "no comment is kept"});
  const HierarchyFile one = read_levels(folder / "a.ply");
  ASSERT_EQ(one.hierarchy.levels.size(), 1U);
  EXPECT_EQ(one.hierarchy.mesh(0).triangles, hierarchy.mesh(1).triangles);
  EXPECT_EQ(one.info.mesh.space, "lps");
  expect_error(ErrorCode::bad_file, "no such file", folder / "none.xyz",
               [&] { read_levels(folder / "none.xyz"); });
  for (const auto& [blocks, message] : {std::pair{"<DataSet index='0'/>", "its block 0 is empty"},
                                        {"<Block index='0'/>", "blocks within blocks"}}) {
    write_bytes(
        folder / "b.vtm",
        std::string("<VTKFile type='vtkMultiBlockDataSet' version='1.0'><vtkMultiBlockDataSet>") +
            blocks + "</vtkMultiBlockDataSet></VTKFile>");
    expect_error(ErrorCode::unsupported, message, folder / "b.vtm",
                 [&] { read_levels(folder / "b.vtm"); });
  }
  write_bytes(folder / "a.xyz", "x");
  expect_error(ErrorCode::unsupported, "one of .ply .stl .obj .off .vtp .3mf .gii, or .glb or .vtm",
               folder / "a.xyz", [&] { read_levels(folder / "a.xyz"); });
}

TEST(HierarchyFiles, LevelsThatAreNotNestedAreRead) {
  const TempFolder folder;
  const Shape shape{.is_balanced = true};
  HierarchyFileInfo info = info_of(shape);
  info.placement = Placement::surface;  // which is false for these levels
  write_hierarchy(sphere(shape), folder / "a.glb", info);
  const HierarchyFile file = read_hierarchy(folder / "a.glb");
  EXPECT_EQ(file.info.placement, Placement::surface);
  EXPECT_FALSE(file.hierarchy.levels[0].own_positions.empty());
  EXPECT_TRUE(file.hierarchy.levels[2].own_positions.empty());
}

/// A .glb file with changed JSON.
std::string with_json(const std::string& glb, const std::function<void(nlohmann::json&)>& change) {
  const auto number = [](std::size_t value) {
    const auto narrow = static_cast<std::uint32_t>(value);
    return std::string(reinterpret_cast<const char*>(&narrow), sizeof narrow);
  };
  std::uint32_t json_bytes = 0;
  std::memcpy(&json_bytes, glb.data() + 12, sizeof json_bytes);
  nlohmann::json json = nlohmann::json::parse(glb.substr(20, json_bytes));
  change(json);
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::string rest = glb.substr(20 + json_bytes);
  return glb.substr(0, 8) + number(20 + text.size() + rest.size()) + number(text.size()) +
         glb.substr(16, 4) + text + rest;
}

// A required extension may move vertices or store them differently.
TEST(HierarchyFiles, GlbThatNeedsAnExtensionIsRefusedByItsName) {
  const TempFolder folder;
  write_hierarchy(sphere({}), folder / "a.glb", info_of({}));
  const std::string whole = read_bytes(folder / "a.glb");
  const auto with_extension = [&](const std::string& name) {
    return with_json(whole, [&](nlohmann::json& json) { json["extensionsRequired"] = {name}; });
  };
  write_bytes(folder / "b.glb", with_extension("KHR_materials_unlit"));
  EXPECT_EQ(read_hierarchy(folder / "b.glb").hierarchy.levels.size(), 3U);
  for (const std::string name :
       {"KHR_draco_mesh_compression", "EXT_mesh_gpu_instancing", "EXT_meshopt_compression"}) {
    write_bytes(folder / "c.glb", with_extension(name));
    expect_error(ErrorCode::unsupported, "needs the glTF extension " + name, folder / "c.glb",
                 [&] { read_levels(folder / "c.glb"); });
  }
}

TEST(HierarchyFiles, GlbOfOtherKindsOfMeshesIsRefused) {
  const TempFolder folder;
  write_hierarchy(sphere({}), folder / "a.glb", info_of({}));
  const std::string whole = read_bytes(folder / "a.glb");
  const auto refused = [&](const std::string& message,
                           const std::function<void(nlohmann::json&)>& change) {
    write_bytes(folder / "b.glb", with_json(whole, change));
    expect_error(ErrorCode::unsupported, message, folder / "b.glb",
                 [&] { read_levels(folder / "b.glb"); });
  };
  const auto primitive = [](nlohmann::json& json) -> nlohmann::json& {
    return json["meshes"][0]["primitives"][0];
  };
  const auto positions = [&](nlohmann::json& json) -> nlohmann::json& {
    return json["accessors"][primitive(json)["attributes"]["POSITION"].get<std::size_t>()];
  };
  refused("not a list of triangles",
          [&](nlohmann::json& json) { primitive(json)["mode"] = 5; });  // a strip
  refused("not a list of triangles",
          [&](nlohmann::json& json) { primitive(json).erase("indices"); });
  refused("has a mesh of 2 primitives", [&](nlohmann::json& json) {
    json["meshes"][0]["primitives"].push_back(primitive(json));
  });
  refused("an accessor of a kind",
          [&](nlohmann::json& json) { positions(json)["normalized"] = true; });
  refused("an accessor of a kind", [&](nlohmann::json& json) {
    positions(json)["sparse"] = {{"count", 1},
                                 {"indices", {{"bufferView", 0}, {"componentType", 5125}}},
                                 {"values", {{"bufferView", 0}}}};
  });
  write_bytes(folder / "b.glb", "{\"asset\": {\"version\": \"2.0\"}}");  // glTF as text
  expect_error(ErrorCode::bad_file, "is not a binary glTF file", folder / "b.glb",
               [&] { read_levels(folder / "b.glb"); });
  write_bytes(folder / "b.glb", with_json(whole, [](nlohmann::json& json) {
                json["buffers"][0]["uri"] = "other.bin";
              }));
  expect_error(ErrorCode::bad_file, "is not a glTF 2.0 file", folder / "b.glb",
               [&] { read_levels(folder / "b.glb"); });
}

// Other programs place a mesh under their own nodes, next to cameras, and write transforms that
// change nothing.
TEST(HierarchyFiles, GlbWithNodesAroundItsMesh) {
  const TempFolder folder;
  const Hierarchy hierarchy = sphere({});
  write_hierarchy(hierarchy, folder / "a.glb", info_of({}));
  const std::string whole = read_bytes(folder / "a.glb");
  const Vec3 before = read_hierarchy(folder / "a.glb").hierarchy.positions[0];
  const auto first_position = [&](const std::function<void(nlohmann::json&)>& change) {
    write_bytes(folder / "b.glb", with_json(whole, change));
    return read_hierarchy(folder / "b.glb").hierarchy.positions[0] - before;
  };
  const auto under_a_parent = [](nlohmann::json& json) {
    const std::size_t parent = json["nodes"].size();
    json["nodes"].push_back({{"translation", {1, 2, 3}}, {"children", json["scenes"][0]["nodes"]}});
    json["nodes"].push_back({{"name", "camera"}});
    json["scenes"][0]["nodes"] = {parent, parent + 1};
  };
  EXPECT_EQ(first_position(under_a_parent), (Vec3{1, 2, 3}));
  const auto with_identities = [](nlohmann::json& json) {
    for (nlohmann::json& node : json["nodes"])
      node["rotation"] = {0, 0, 0, 1}, node["scale"] = {1, 1, 1};
  };
  EXPECT_EQ(first_position(with_identities), (Vec3{0, 0, 0}));
  const auto with_weights = [](double weight) {
    return [weight](nlohmann::json& json) {
      for (nlohmann::json& mesh : json["meshes"]) mesh["weights"] = {0, weight};
    };
  };
  EXPECT_EQ(first_position(with_weights(0)), (Vec3{0, 0, 0}));
  write_bytes(folder / "b.glb", with_json(whole, with_weights(0.5)));
  expect_error(ErrorCode::unsupported, "morph targets", folder / "b.glb",
               [&] { read_hierarchy(folder / "b.glb"); });
  write_bytes(folder / "b.glb",
              with_json(whole, [](nlohmann::json& json) { json["nodes"][0]["skin"] = 0; }));
  expect_error(ErrorCode::unsupported, "skeleton", folder / "b.glb",
               [&] { read_hierarchy(folder / "b.glb"); });
  for (const std::function<void(nlohmann::json&)>& change :
       {std::function<void(nlohmann::json&)>([](nlohmann::json& json) {
          json["nodes"][0]["scale"] = {1, 2, 1};
        }),
        std::function<void(nlohmann::json&)>([](nlohmann::json& json) {
          json["scenes"][0]["nodes"] = {0, 1};
        })}) {
    write_bytes(folder / "b.glb", with_json(whole, change));
    EXPECT_THROW(read_hierarchy(folder / "b.glb"), Error);
  }
  write_bytes(folder / "b.glb", with_json(whole, [&](nlohmann::json& json) {
                under_a_parent(json);
                json["nodes"][json["nodes"].size() - 2]["children"] = {json["nodes"].size() - 2};
              }));
  expect_error(ErrorCode::bad_file, "its own ancestor", folder / "b.glb",
               [&] { read_hierarchy(folder / "b.glb"); });
}

}  // namespace
}  // namespace isoatlas::detail::test
