// SPDX-License-Identifier: Apache-2.0
// Meshes for Neuroglancer, read by a reader of this file: manifest and fragments as the format's
// specification describes them. tests/hosts/neuroglancer has other programs' readers.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "isoatlas/extract.h"
#include "isoatlas/neuroglancer.h"
#include "mesh_files/draco_mesh.h"
#include "mesh_files/lattice_mesh.h"
#include "support/file_test_support.h"
#include "support/mesh_counts.h"
#include "support/surfaces.h"
#include "support/volumes.h"

namespace isoatlas {
namespace {

using namespace detail::test;
namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Reads the numbers of a file, 4 bytes each.
class Numbers {
 public:
  explicit Numbers(std::string bytes) : bytes_(std::move(bytes)) {}
  std::uint32_t integer() {
    std::uint32_t out = 0;
    for (int k = 0; k < 4; ++k)
      out |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes_.at(at_++))) << (8 * k);
    return out;
  }
  float real() { return std::bit_cast<float>(integer()); }
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

// The levels, finest first, in the coordinates of the manifest.
struct Read {
  std::vector<TriangleMesh> lods;
  std::vector<std::size_t> fragments;
  std::vector<float> scales;
  std::vector<double> transform;
};

Read read(const fs::path& folder) {
  const auto info = nlohmann::json::parse(contents(folder / "info"));
  EXPECT_EQ(info.at("@type"), "neuroglancer_multilod_draco");
  EXPECT_EQ(info.at("vertex_quantization_bits"), 16);
  Read out;
  out.transform = info.at("transform").get<std::vector<double>>();
  Numbers manifest(contents(folder / "1.index"));
  const std::string data = contents(folder / "1");
  std::array<double, 3> chunk, origin;
  for (double& x : chunk) x = static_cast<double>(manifest.real());
  for (double& x : origin) x = static_cast<double>(manifest.real());
  const std::uint32_t lods = manifest.integer();
  for (std::uint32_t k = 0; k < lods; ++k) out.scales.push_back(manifest.real());
  for (std::uint32_t k = 0; k < 3 * lods; ++k) EXPECT_EQ(manifest.real(), 0);
  for (std::uint32_t k = 0; k < lods; ++k) out.fragments.push_back(manifest.integer());
  std::size_t begin = 0;
  for (std::uint32_t k = 0; k < lods; ++k) {
    std::array<std::vector<std::uint32_t>, 3> cell;
    for (auto& axis : cell) {
      for (std::size_t i = 0; i < out.fragments[k]; ++i) axis.push_back(manifest.integer());
    }
    TriangleMesh& mesh = out.lods.emplace_back();
    std::map<std::array<double, 3>, std::uint32_t> number;
    for (std::size_t i = 0; i < out.fragments[k]; ++i) {
      const std::size_t size = manifest.integer();
      const std::string bytes = data.substr(begin, size);
      begin += size;
      if (size == 0) continue;
      const detail::io::IntegerMesh fragment = detail::io::mesh_of_draco(bytes);
      std::vector<std::uint32_t> vertex;
      for (const auto& p : fragment.positions) {
        std::array<double, 3> at;
        for (std::size_t a = 0; a < 3; ++a) {
          EXPECT_GE(p[a], 0);
          EXPECT_LE(p[a], 65535);
          at[a] = origin[a] + std::ldexp(chunk[a], static_cast<int>(k)) *
                                  (cell[a][i] + static_cast<double>(p[a]) / 65535);
        }
        const auto [found, is_new] =
            number.try_emplace(at, static_cast<std::uint32_t>(mesh.positions.size()));
        if (is_new) mesh.positions.push_back({at[0], at[1], at[2]});
        vertex.push_back(found->second);
      }
      for (const Triangle& t : fragment.triangles) {
        mesh.triangles.push_back({vertex[t[0]], vertex[t[1]], vertex[t[2]]});
        // No triangle of a coarser level is on both sides of the middle of its fragment.
        for (std::size_t a = 0; a < 3 && k > 0; ++a) {
          const auto side = [&](std::uint32_t v) {
            return fragment.positions[v][a] < 32768 ? -1 : fragment.positions[v][a] > 32768 ? 1 : 0;
          };
          EXPECT_GE(side(t[0]) * side(t[1]), 0);
          EXPECT_GE(side(t[1]) * side(t[2]), 0);
          EXPECT_GE(side(t[2]) * side(t[0]), 0);
        }
      }
    }
  }
  EXPECT_EQ(begin, data.size());
  EXPECT_TRUE(manifest.at_end());
  return out;
}

class Neuroglancer : public testing::Test {
 protected:
  TempFolder parent_;
  const fs::path folder_ = parent_ / "mesh";
};

Extraction example() {
  ExtractOptions options;
  options.refine = {within(2 * vx), within(0.5 * vx)};
  Volume volume = to_volume(sampled({30, 26, 24}, torus({14.5, 12.5, 11.5}, 8, 3.1)));
  volume.view.grid.origin = {-1000, 20, 3};
  return extract(volume, options);
}

TEST_F(Neuroglancer, LevelsHaveTheirTopologyAndPositions) {
  const Extraction made = example();
  HierarchyFileInfo info;
  info.mesh.unit = LengthUnit::micrometre;
  const NeuroglancerMesh facts = write_neuroglancer(made.hierarchy, folder_, info);
  const Read found = read(folder_);
  const std::size_t levels = made.hierarchy.levels.size();
  ASSERT_EQ(found.lods.size(), levels);
  ASSERT_EQ(facts.rounding.size(), levels);
  EXPECT_TRUE(std::is_sorted(found.scales.begin(), found.scales.end()));
  for (std::size_t k = 0; k < levels; ++k) {
    const TriangleMesh& stored = found.lods[levels - 1 - k];
    EXPECT_EQ(text(kinds_of(stored)), text(kinds_of(made.hierarchy.mesh(k))));
    EXPECT_EQ(facts.self_intersections[k], 0u);
    EXPECT_GT(facts.rounding[k], 0);
    EXPECT_LT(facts.rounding[k], 0.01);
    // Every vertex is stored.
    for (const Vec3& p : made.hierarchy.mesh(k).positions) {
      double nearest = INFINITY;
      for (const Vec3& q : stored.positions) {
        const Vec3 at{q.x + found.transform[3] / 1000, q.y + found.transform[7] / 1000,
                      q.z + found.transform[11] / 1000};
        nearest = std::min(nearest, std::hypot(at.x - p.x, at.y - p.y, at.z - p.z));
      }
      EXPECT_LE(nearest, facts.rounding[k] * 1.001 + 1e-6);
    }
  }
  EXPECT_EQ(found.transform[0], 1000);  // nanometres per micrometre
}

TEST_F(Neuroglancer, FragmentsOfAFineMeshFit) {
  // More triangles than one fragment may have.
  const TriangleMesh fine =
      detail::test::triangles_of(surface_of(sampled({48, 48, 48}, gyroid(13, 0.2))));
  ASSERT_GT(fine.triangles.size(), 60000u);
  write_neuroglancer(hierarchy_of({fine, fine}), folder_);
  const Read found = read(folder_);
  EXPECT_EQ(found.fragments, (std::vector<std::size_t>{8, 1}));
  for (const TriangleMesh& stored : found.lods)
    EXPECT_EQ(text(kinds_of(stored)), text(kinds_of(fine)));
}

TEST_F(Neuroglancer, AFolderOfSomethingElseIsKept) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "info") << R"({"@type": "neuroglancer_multiscale_volume"})";
  try {
    write_neuroglancer(example().hierarchy, folder_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_file);
    EXPECT_NE(std::string(error.what()).find("something else"), std::string::npos);
  }
  EXPECT_FALSE(fs::exists(folder_ / "1"));
}

TEST(LatticeMesh, CutsAreTheSameOnBothSides) {
  using namespace detail::io;
  // A surface with its vertices at random, cut every 7 steps.
  const Extraction made = example();
  const TriangleMesh mesh = made.hierarchy.mesh(made.hierarchy.levels.size() - 1);
  for (const double step : {0.011, 0.05}) {
    LatticeMesh lattice = on_lattice(mesh.positions, mesh.triangles, {-1100, 0, 0}, step);
    const std::size_t before = lattice.triangles.size();
    cut_at_planes(lattice, [](std::int64_t x) { return (x / 70 + 1) * 70; });
    EXPECT_GT(lattice.triangles.size(), 2 * before);
    TriangleMesh cut;
    for (const LatticePoint& p : lattice.positions)
      cut.positions.push_back(
          {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
    cut.triangles = lattice.triangles;
    EXPECT_EQ(text(kinds_of(cut)), text(kinds_of(mesh)));
    for (const Triangle& t : cut.triangles) {
      for (const int axis : {0, 1, 2}) {
        const auto at = [&](std::uint32_t v) {
          return lattice.positions[v][static_cast<std::size_t>(axis)];
        };
        const auto [low, high] = std::minmax({at(t[0]), at(t[1]), at(t[2])});
        EXPECT_LE(high, (low / 70 + 1) * 70);
      }
    }
  }
}

}  // namespace
}  // namespace isoatlas
