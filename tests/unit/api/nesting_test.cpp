// SPDX-License-Identifier: Apache-2.0
// Orientation and nesting of components are the same at every level. The reference sums solid
// angles and uses neither grids nor predicates.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/vector_math.h"
#include "isoatlas/extract.h"
#include "support/surfaces.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using namespace test;

// The solid angle of a triangle seen from p, signed (Van Oosterom and Strackee 1983).
double solid_angle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  a = a - p, b = b - p, c = c - p;
  const double la = length(a), lb = length(b), lc = length(c);
  return 2 * std::atan2(dot(a, cross(b, c)),
                        la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

// Computes, for two vertices of a level, how often the component of the second winds around the
// first.
class Windings {
 public:
  explicit Windings(const TriangleMesh& mesh) : mesh_(mesh), counts_(count_manifold(mesh)) {}

  int around(std::uint32_t vertex, std::uint32_t of) const {
    const std::uint32_t component = counts_.component_of_vertex[of];
    if (component == counts_.component_of_vertex[vertex]) return 0;
    double sum = 0;
    for (const Triangle& t : mesh_.triangles) {
      if (counts_.component_of_vertex[t[0]] != component) continue;
      sum += solid_angle(mesh_.positions[vertex], mesh_.positions[t[0]], mesh_.positions[t[1]],
                         mesh_.positions[t[2]]);
    }
    return static_cast<int>(std::lround(sum / (4 * std::numbers::pi)));
  }

  // Six times the signed volume is positive.
  bool faces_outward(std::uint32_t vertex) const {
    double sum = 0;
    for (const Triangle& t : mesh_.triangles) {
      if (counts_.component_of_vertex[t[0]] != counts_.component_of_vertex[vertex]) continue;
      const Vec3 p = mesh_.positions[vertex];
      sum += dot(mesh_.positions[t[0]] - p,
                 cross(mesh_.positions[t[1]] - p, mesh_.positions[t[2]] - p));
    }
    return sum > 0;
  }

  std::vector<std::uint32_t> one_of_each() const {
    std::vector<std::uint32_t> out;
    for (std::uint32_t v = 0; v < counts_.component_of_vertex.size(); ++v) {
      if (counts_.component_of_vertex[v] == out.size()) out.push_back(v);
    }
    return out;
  }

  bool is_open(std::uint32_t vertex) const {
    return counts_.components[counts_.component_of_vertex[vertex]].boundary_loops > 0;
  }

 private:
  const TriangleMesh& mesh_;
  MeshCounts counts_;
};

TEST(Nesting, IsTheSameAtEveryLevel) {
  std::size_t enclosed = 0, inward = 0;
  const std::uint64_t seeds = is_thorough() ? 30 : 12;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    SCOPED_TRACE(seed);
    const Samples samples = seed % 3 == 0 ? random_samples(Family::white_noise, {12, 11, 13}, seed)
                                          : random_shells(seed);
    ExtractOptions options = coarse_options();
    options.refine = {{{Quantity::max_distance, 1}}, {{Quantity::max_distance, 0.4}}};
    const Extraction e = extract(to_volume(samples), options);
    std::vector<TriangleMesh> meshes;
    for (std::size_t k = 0; k < 3; ++k) meshes.push_back(e.hierarchy.mesh(k));
    const Windings finest(meshes[2]);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(e.report.levels[k].inverted_components, 0U);
      const Windings level(meshes[k]);
      for (const std::uint32_t a :
           level.one_of_each()) {  // vertices keep their ids in later levels
        ASSERT_EQ(level.is_open(a), finest.is_open(a)) << "level " << k << ", vertex " << a;
        if (level.is_open(a)) continue;
        ASSERT_EQ(level.faces_outward(a), finest.faces_outward(a))
            << "level " << k << ", vertex " << a;
        inward += finest.faces_outward(a) ? 0 : 1;
        for (const std::uint32_t b : level.one_of_each()) {
          if (level.is_open(b)) continue;
          ASSERT_EQ(level.around(a, b), finest.around(a, b))
              << "level " << k << ", vertices " << a << " and " << b;
          enclosed += finest.around(a, b) != 0 ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(enclosed, 2 * seeds);
  EXPECT_GT(inward, 3 * seeds);
}

}  // namespace
}  // namespace isoatlas::detail
