// SPDX-License-Identifier: Apache-2.0
#include "levels/predict_radii.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "support/levels.h"

namespace isoatlas::detail {
namespace {

using namespace test;

std::vector<CVertexId> all_of(const SurfaceComplex& surface) {
  std::vector<CVertexId> out(surface.c_vertex_count());
  std::iota(out.begin(), out.end(), 0u);
  return out;
}

// A disk of radius r on a sphere of radius R has height r^2 / 2R, so the right radius for a bound b
// is sqrt(2 b R); the prediction is a little larger.
TEST(PredictRadii, FollowTheCurvatureOfASphere) {
  for (const double spacing : {1.0, 0.25}) {
    for (const double radius : {8.0, 17.0}) {
      const SurfaceComplex surface =
          surface_of(sampled({40, 40, 40}, sphere({19.4, 19.6, 19.55}, radius)), 0, Inside::above,
                     {spacing, spacing, spacing});
      const SurfaceData surface_data(surface);
      for (const double bound : {0.1, 0.5}) {
        const std::vector<Covering::Radius> radii =
            predict_radii(surface_data, all_of(surface), bound * spacing);
        ASSERT_EQ(radii.size(), surface.c_vertex_count());
        const double right = spacing * std::sqrt(2 * bound * radius);
        double sum = 0;
        for (const Covering::Radius& r : radii) {
          ASSERT_GT(static_cast<double>(r.radius), 0.7 * right);
          ASSERT_LT(static_cast<double>(r.radius), 3 * right);
          sum += static_cast<double>(r.radius) / right;
        }
        EXPECT_GT(sum / static_cast<double>(radii.size()), 1.2);
        EXPECT_LT(sum / static_cast<double>(radii.size()), 2);
      }
    }
  }
}

// Where the surface is flat, nothing is known beyond the neighbourhood.
TEST(PredictRadii, AreLimitedOnAPlane) {
  const SurfaceComplex surface =
      surface_of(sampled({20, 20, 20}, [](double, double, double z) { return 9.5 - z; }));
  const SurfaceData surface_data(surface);
  for (const Covering::Radius& r : predict_radii(surface_data, all_of(surface), 0.5)) {
    EXPECT_GT(r.radius, 5 * surface_data.farthest_neighbour[r.at]);
    EXPECT_LT(r.radius, 20 * surface_data.farthest_neighbour[r.at]);
  }
}

TEST(PredictRadii, AreEmptyForATinyComponent) {
  const SurfaceComplex surface = tetrahedron();
  EXPECT_TRUE(predict_radii(SurfaceData(surface), all_of(surface), 0.5).empty());
}

}  // namespace
}  // namespace isoatlas::detail
