// SPDX-License-Identifier: Apache-2.0
#include "page/geometry.h"

#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>

#include "isoatlas/error.h"
#include "isoatlas/extract.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using Json = nlohmann::ordered_json;

std::string part(const std::string& bytes, const Json& range) {
  return bytes.substr(range["offset"].get<std::size_t>(), range["bytes"].get<std::size_t>());
}

std::vector<Vec3> positions_of(const std::string& bytes, const Json& range) {
  const std::string code = part(bytes, range);
  std::vector<std::array<std::uint32_t, 3>> steps(range["count"].get<std::size_t>());
  EXPECT_EQ(
      meshopt_decodeVertexBuffer(steps.data(), steps.size(), 12,
                                 reinterpret_cast<const unsigned char*>(code.data()), code.size()),
      0);
  std::vector<Vec3> out;
  const double step = range["step"];
  for (const auto& s : steps)
    out.push_back({range["origin"][0].get<double>() + step * s[0],
                   range["origin"][1].get<double>() + step * s[1],
                   range["origin"][2].get<double>() + step * s[2]});
  return out;
}

std::vector<Triangle> triangles_of(const std::string& bytes, const Json& range) {
  const std::string code = part(bytes, range);
  std::vector<Triangle> out(range["count"].get<std::size_t>());
  EXPECT_EQ(
      meshopt_decodeIndexBuffer(out.data(), 3 * out.size(), 4,
                                reinterpret_cast<const unsigned char*>(code.data()), code.size()),
      0);
  return out;
}

std::vector<Triangle> normalised(std::vector<Triangle> triangles) {
  for (Triangle& t : triangles)
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

Extraction levels(Placement placement) {
  ExtractOptions options = test::coarse_options();
  options.placement = placement;
  options.refine = {{{Quantity::max_distance, 1}}, {{Quantity::max_distance, 0.3}}};
  return extract(test::to_volume(test::random_samples(test::Family::white_noise, {6, 7, 8}, 5)),
                 options);
}

TEST(PageGeometry, LevelsRoundTrip) {
  for (const Placement placement : {Placement::surface, Placement::balanced}) {
    const Hierarchy hierarchy = levels(placement).hierarchy;
    std::string bytes = "before";
    const Json json = page::append_geometry(hierarchy, "page.html", bytes);
    EXPECT_TRUE(bytes.starts_with("before")) << "earlier bytes are kept";
    ASSERT_EQ(json["levels"].size(), hierarchy.levels.size());
    for (std::size_t k = 0; k < hierarchy.levels.size(); ++k) {
      const Json& level = json["levels"][k];
      const TriangleMesh mesh = hierarchy.mesh(k);
      EXPECT_EQ(level["vertices"], mesh.positions.size());
      EXPECT_EQ(level.contains("own_positions"), !hierarchy.levels[k].own_positions.empty());
      const Json& where =
          level.contains("own_positions") ? level["own_positions"] : json["positions"];
      const std::vector<Vec3> positions = positions_of(bytes, where);
      ASSERT_GE(positions.size(), mesh.positions.size());
      const double step = where["step"];
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        EXPECT_LE(std::abs(positions[v].x - mesh.positions[v].x), 0.51 * step);
        EXPECT_LE(std::abs(positions[v].y - mesh.positions[v].y), 0.51 * step);
        EXPECT_LE(std::abs(positions[v].z - mesh.positions[v].z), 0.51 * step);
      }
      EXPECT_EQ(normalised(triangles_of(bytes, level["triangles"])), normalised(mesh.triangles));
      const std::string shares = part(bytes, level["distance"]);
      const float most = level["distance"]["maximum"];
      ASSERT_EQ(shares.size(), mesh.positions.size());
      for (std::size_t v = 0; v < shares.size(); ++v) {
        const double shown = static_cast<unsigned char>(shares[v]) * double{most} / 255;
        EXPECT_GE(shown, hierarchy.levels[k].distance[v] * (1 - 1e-6))
            << "never less than the distance";
        EXPECT_LE(shown, hierarchy.levels[k].distance[v] + most / 254);
      }
    }
    std::string again = "before";
    EXPECT_EQ(page::append_geometry(hierarchy, "page.html", again), json);
    EXPECT_EQ(again, bytes);
  }
}

// A tetrahedron with one face split into three at a vertex (apart, apart, 0), near the corner at
// the origin.
Hierarchy with_near_vertices(double apart) {
  Hierarchy h;
  h.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {apart, apart, 0}};
  h.levels.push_back(
      {5, {{0, 2, 4}, {2, 1, 4}, {1, 0, 4}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}, {}, {}});
  h.parent = {0, 1, 2, 3, 4};
  return h;
}

TEST(PageGeometry, TheGridIsAsFineAsNeeded) {
  std::string bytes;
  EXPECT_EQ(page::append_geometry(with_near_vertices(0.2), "p", bytes)["positions"]["step"],
            1.0 / 0xfffff);
  EXPECT_EQ(page::append_geometry(with_near_vertices(2e-7), "p", bytes)["positions"]["step"],
            1.0 / 0x3fffff);
  EXPECT_EQ(page::append_geometry(with_near_vertices(1e-7), "p", bytes)["positions"]["step"],
            1.0 / 0xffffff);
  try {
    page::append_geometry(with_near_vertices(1e-9), "p.html", bytes);
    FAIL() << "vertices were merged";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_file);
    EXPECT_NE(std::string(error.what()).find("p.html: "), std::string::npos) << error.what();
  }
}

TEST(PageGeometry, WorksFarFromTheOriginAndAtAnyScale) {
  for (const double scale : {1e-12, 1.0, 1e12}) {
    Hierarchy h = with_near_vertices(0.2);
    for (Vec3& p : h.positions) p = {scale * (p.x + 1e5), scale * (p.y - 1e5), scale * p.z};
    std::string bytes;
    const Json json = page::append_geometry(h, "p", bytes);
    const std::vector<Vec3> positions = positions_of(bytes, json["positions"]);
    for (std::size_t v = 0; v < positions.size(); ++v)
      EXPECT_NEAR(positions[v].x, h.positions[v].x, scale * 1e-5);
    EXPECT_FALSE(json["levels"][0].contains("distance"));
  }
}

}  // namespace
}  // namespace isoatlas::detail
