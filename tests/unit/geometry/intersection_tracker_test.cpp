// SPDX-License-Identifier: Apache-2.0
#include "geometry/intersection_tracker.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

// Two triangles that cross, and two that share an edge.
const std::vector<Vec3> kPositions{{0, 0, 0}, {4, 0, 0},     {0, 4, 0}, {1, 1, -1},
                                   {1, 1, 1}, {1.2, 1.2, 1}, {9, 0, 0}};
const std::vector<Triangle> kTriangles{{0, 1, 2}, {3, 4, 5}, {2, 1, 6}};

TEST(IntersectionTracker, LargestCornerOfEachPair) {
  IntersectionTracker tracker;
  const std::vector<std::uint32_t> corners = tracker.update(kPositions, kTriangles, {});
  EXPECT_EQ(corners, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(tracker.pair_count(), 1u);
  EXPECT_EQ(tracker.largest_corners(std::vector<float>{1, 1, 1, 3, 1, 2, 9}),
            (std::vector<std::uint32_t>{3}));
  EXPECT_EQ(tracker.largest_corners(std::vector<float>{1, 2, 2, 2, 1, 1, 9}),
            (std::vector<std::uint32_t>{1}))
      << "ties: the first";
  EXPECT_EQ(tracker.largest_corners(std::vector<float>{0, 0, 0, 0, 0, 0, 9}), corners)
      << "none can be made smaller";
}

// A sequence of meshes whose triangles and positions stay, move, appear and disappear gives the
// same results as complete tests.
TEST(IntersectionTracker, SameAsCompleteTests) {
  test::Random random(11);
  const auto somewhere = [&] {
    const auto at = [&] { return static_cast<double>(random.between(0, 1000)); };
    return Vec3{at(), at(), at()};
  };
  std::vector<Vec3> positions(60);
  std::generate(positions.begin(), positions.end(), somewhere);
  const auto any_triangle = [&] {
    const auto first = static_cast<std::uint32_t>(random.between(0, 57));
    return Triangle{first, first + 1, first + 2};
  };
  std::vector<Triangle> triangles(40);
  std::generate(triangles.begin(), triangles.end(), any_triangle);
  IntersectionTracker tracker;
  std::size_t seen = 0;
  for (int round = 0; round < 200; ++round) {
    for (Triangle& t : triangles) std::sort(t.begin(), t.end());
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    Triangle& inverted = triangles[static_cast<std::size_t>(round) % triangles.size()];
    std::rotate(inverted.begin(), inverted.begin() + 1,
                inverted.end());  // the same triangle with another first corner
    const std::vector<std::uint32_t> corners = tracker.update(positions, triangles, {});
    IntersectionTracker anew;
    ASSERT_EQ(corners, anew.update(positions, triangles, {})) << "round " << round;
    ASSERT_EQ(tracker.pair_count(), anew.pair_count()) << "round " << round;
    seen += tracker.pair_count();
    positions[static_cast<std::size_t>(random.between(0, 59))] = somewhere();
    if (random.between(0, 1) == 0) positions.push_back(somewhere());
    triangles[static_cast<std::size_t>(
        random.between(0, static_cast<std::int64_t>(triangles.size()) - 1))] = any_triangle();
    if (triangles.size() < 30) triangles.push_back(any_triangle());
  }
  EXPECT_GT(seen, 1000u);
}

}  // namespace
}  // namespace isoatlas::detail
