// SPDX-License-Identifier: Apache-2.0
#include "geometry/triangle_pair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>

#include "exact_triangles.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using test::LatticePoint;
using test::Random;
using test::slow_intersect_beyond_shared_simplex;
using test::to_positions;

struct Case {
  std::string name;
  bool intersect;
  std::vector<LatticePoint> points;
  Triangle a, b;
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

// One triangle has the corners 0, 1, 2, mostly (0, 0, 0), (4, 0, 0), (0, 4, 0).
std::vector<Case> cases() {
  const LatticePoint o{0, 0, 0}, x{4, 0, 0}, y{0, 4, 0};
  const Triangle first{0, 1, 2}, apart{3, 4, 5};
  const auto with = [&](std::vector<LatticePoint> more) {
    std::vector<LatticePoint> out{o, x, y};
    out.insert(out.end(), more.begin(), more.end());
    return out;
  };
  return {
      // No shared corner.
      {"far", false, with({{9, 9, 9}, {8, 9, 9}, {9, 8, 9}}), first, apart},
      {"parallel", false, with({{0, 0, 1}, {4, 0, 1}, {0, 4, 1}}), first, apart},
      {"beside_in_one_plane", false, with({{5, 5, 0}, {4, 1, 0}, {1, 4, 0}}), first, apart},
      {"plane_crossed_beside_the_triangle", false, with({{3, 3, -1}, {3, 3, 1}, {5, 5, 0}}), first,
       apart},
      {"piercing", true, with({{1, 1, -1}, {1, 1, 1}, {5, 5, 0}}), first, apart},
      {"edge_through_interior", true, with({{1, 1, -1}, {1, 1, 1}, {-5, -5, 7}}), first, apart},
      {"corner_on_interior", true, with({{1, 1, 0}, {1, 1, 5}, {2, 2, 5}}), first, apart},
      {"corner_on_edge", true, with({{2, 2, 0}, {5, 5, 5}, {5, 5, -5}}), first, apart},
      {"corner_on_corner", true, with({{4, 0, 0}, {9, 0, 1}, {9, 1, -1}}), first, apart},
      {"edges_cross_at_one_point", true, with({{2, 0, -1}, {2, 0, 1}, {2, -5, 0}}), first, apart},
      {"edge_on_edge", true, with({{1, 0, 0}, {3, 0, 0}, {2, -3, 1}}), first, apart},
      {"edge_lies_in_interior", true, with({{1, 1, 0}, {1, 2, 0}, {1, 1, 3}}), first, apart},
      {"overlap_in_one_plane", true, with({{1, 1, 0}, {6, 1, 0}, {1, 6, 0}}), first, apart},
      {"inside_in_one_plane", true, with({{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}), first, apart},
      {"star_in_one_plane",
       true,
       {{0, 0, 0}, {6, 0, 0}, {3, 6, 0}, {0, 4, 0}, {6, 4, 0}, {3, -2, 0}},
       first,
       apart},
      {"touch_at_corners_in_one_plane", true, with({{4, 0, 0}, {8, 0, 0}, {8, 4, 0}}), first,
       apart},
      {"touch_along_edges_in_one_plane", true, with({{4, 0, 0}, {0, 4, 0}, {4, 4, 0}}), first,
       apart},
      {"same_place_other_vertices", true, with({o, x, y}), first, apart},
      // One shared corner, vertex 0.
      {"fan", false, with({{-4, 0, 0}, {0, -4, 0}}), first, {0, 3, 4}},
      {"corner_only_other_plane", false, with({{1, 1, 3}, {2, 1, 3}}), first, {0, 3, 4}},
      {"line_through_corner_leaves_other_triangle",
       false,
       with({{-1, -1, 1}, {-1, -1, -1}}),
       first,
       {0, 3, 4}},
      {"pierced_from_shared_corner", true, with({{1, 1, 1}, {1, 1, -1}}), first, {0, 3, 4}},
      {"pierces_the_opposite_edge", true, with({{3, 3, 1}, {3, 3, -1}}), first, {0, 3, 4}},
      {"edge_lies_in_the_other", true, with({{1, 1, 0}, {0, 0, 5}}), first, {0, 3, 4}},
      {"edge_continues_the_others_edge", true, with({{8, 0, 0}, {0, 0, 5}}), first, {0, 3, 4}},
      {"edge_runs_the_other_way", false, with({{-4, 0, 0}, {0, 0, 5}}), first, {0, 3, 4}},
      {"opposite_corner_touches_edge", true, with({{2, 2, 0}, {0, 0, 5}}), first, {0, 3, 4}},
      {"overlapping_fan", true, with({{1, 1, 0}, {-1, 4, 0}}), first, {0, 3, 4}},
      {"nested_fan", true, with({{2, 1, 0}, {1, 2, 0}}), first, {0, 3, 4}},
      {"fan_side_by_side", true, with({{0, 2, 0}, {-4, 0, 0}}), first, {0, 3, 4}},
      {"twin_vertices_in_place_of_an_edge", true, with({{4, 0, 0}, {0, -4, 0}}), first, {0, 3, 4}},
      // Shared edge 0, 1.
      {"flat", false, with({{4, -4, 0}}), first, {1, 0, 3}},
      {"right_angle", false, with({{0, 0, 4}}), first, {1, 0, 3}},
      {"acute", false, with({{0, 20, 1}}), first, {1, 0, 3}},
      {"folded_over", true, with({{1, 1, 0}}), first, {1, 0, 3}},
      {"folded_over_and_beyond", true, with({{9, 1, 0}}), first, {1, 0, 3}},
      {"folded_onto_itself", true, with({{0, 4, 0}}), first, {1, 0, 3}},
      // All corners.
      {"twice", true, with({}), first, first},
      {"twice_reversed", true, with({}), first, {2, 1, 0}},
      // Without area.
      {"segment_through", true, with({{1, 1, -1}, {1, 1, 1}, {1, 1, 0}}), first, apart},
      {"segment_ends_before", false, with({{1, 1, 1}, {1, 1, 3}, {1, 1, 2}}), first, apart},
      {"segment_touches", true, with({{1, 1, 0}, {1, 1, 3}, {1, 1, 2}}), first, apart},
      {"segments_cross",
       true,
       {{0, 0, 0}, {2, 2, 0}, {1, 1, 0}, {2, 0, 0}, {0, 2, 0}, {2, 0, 0}},
       first,
       apart},
      {"segments_pass",
       false,
       {{0, 0, 0}, {2, 2, 0}, {1, 1, 0}, {2, 0, 1}, {0, 2, 1}, {2, 0, 1}},
       first,
       apart},
      {"segments_on_a_line_apart",
       false,
       {{0, 0, 0}, {2, 2, 2}, {1, 1, 1}, {3, 3, 3}, {5, 5, 5}, {3, 3, 3}},
       first,
       apart},
      {"point_in_triangle", true, with({{1, 1, 0}, {1, 1, 0}, {1, 1, 0}}), first, apart},
      {"point_beside", false, with({{3, 3, 0}, {3, 3, 0}, {3, 3, 0}}), first, apart},
      {"point_on_segment",
       true,
       {{0, 0, 0}, {2, 4, 6}, {2, 4, 6}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}},
       first,
       apart},
      {"points_apart",
       false,
       {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}},
       first,
       apart},
      {"segment_from_corner_into", true, with({{1, 1, 0}, {2, 2, 0}}), first, {0, 3, 4}},
      {"segment_from_corner_away", false, with({{1, 1, 1}, {2, 2, 2}}), first, {0, 3, 4}},
      {"segment_across_corner", true, with({{1, 1, 0}, {-1, -1, 0}}), first, {0, 3, 4}},
      {"segment_across_corner_outside", false, with({{1, -1, 0}, {-1, 1, 0}}), first, {0, 3, 4}},
      {"flat_ear_on_its_edge", false, with({{2, 0, 0}}), first, {1, 0, 3}},
      {"flat_ear_beyond_its_edge", false, with({{7, 0, 0}}), first, {1, 0, 3}},
      {"two_flat_ears_one_end",
       true,
       {{0, 0, 0}, {4, 0, 0}, {6, 0, 0}, {5, 0, 0}},
       first,
       {1, 0, 3}},
      {"two_flat_ears_two_ends",
       false,
       {{0, 0, 0}, {4, 0, 0}, {6, 0, 0}, {-1, 0, 0}},
       first,
       {1, 0, 3}},
      {"edge_of_no_length_and_fan",
       false,
       {{0, 0, 0}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}},
       first,
       {1, 0, 3}},
      {"edge_of_no_length_and_overlap",
       true,
       {{0, 0, 0}, {0, 0, 0}, {4, 0, 0}, {2, 0, 0}},
       first,
       {1, 0, 3}},
      {"corner_twice_is_an_edge", false, with({{9, 9, 9}}), first, {0, 1, 1}},
      {"corner_twice_into", true, with({{1, 1, 0}}), first, {0, 0, 3}},
      {"corner_twice_away", false, with({{1, 1, 1}}), first, {0, 3, 3}},
      {"corner_thrice", false, with({}), first, {0, 0, 0}},
  };
}

class TrianglePair : public testing::TestWithParam<Case> {};

TEST_P(TrianglePair, IsAsDrawn) {
  const Case& c = GetParam();
  EXPECT_EQ(intersect_beyond_shared_simplex(to_positions(c.points), c.a, c.b), c.intersect);
  EXPECT_EQ(slow_intersect_beyond_shared_simplex(c.points, c.a, c.b), c.intersect)
      << "the second opinion is wrong";
}

// The order of the triangles, their first corners, their orientation and the axes make no
// difference.
TEST_P(TrianglePair, DoesNotDependOnOrder) {
  const Case& c = GetParam();
  Triangle a = c.a;
  std::sort(a.begin(), a.end());
  do {
    Triangle b = c.b;
    std::sort(b.begin(), b.end());
    do {
      std::array<int, 3> axes{0, 1, 2};
      do {
        std::vector<LatticePoint> inverted;
        for (const LatticePoint& p : c.points)
          inverted.push_back({p[axes[0]], -p[axes[1]], p[axes[2]]});
        const std::vector<Vec3> positions = to_positions(inverted);
        ASSERT_EQ(intersect_beyond_shared_simplex(positions, a, b), c.intersect);
        ASSERT_EQ(intersect_beyond_shared_simplex(positions, b, a), c.intersect);
      } while (std::next_permutation(axes.begin(), axes.end()));
    } while (std::next_permutation(b.begin(), b.end()));
  } while (std::next_permutation(a.begin(), a.end()));
}

// From the smallest doubles to the largest, and far from the origin.
TEST_P(TrianglePair, DoesNotDependOnScale) {
  const Case& c = GetParam();
  for (const double scale : {0x1p-1074, 0x1p-1030, 0x1p-400, 0x1p-200, 0x1p200, 0x1p400, 0x1p1015})
    EXPECT_EQ(intersect_beyond_shared_simplex(to_positions(c.points, scale), c.a, c.b), c.intersect)
        << scale;
  EXPECT_EQ(intersect_beyond_shared_simplex(to_positions(c.points, 1, {0x1p45, -0x1p46, 0x1p47}),
                                            c.a, c.b),
            c.intersect);
  EXPECT_EQ(intersect_beyond_shared_simplex(to_positions(c.points, 0x1p-40, {1, 1, 1}), c.a, c.b),
            c.intersect);
}

INSTANTIATE_TEST_SUITE_P(Drawn, TrianglePair, testing::ValuesIn(cases()),
                         [](const auto& drawn) { return drawn.param.name; });

// Small boxes of lattice points, where nearly every position is special.
TEST(TrianglePairRandom, AgreesWithIntegers) {
  Random random(4);
  std::array<std::array<std::size_t, 2>, 4> seen{};  // by number of shared corners and result
  for (int round = 0; round < 300'000; ++round) {
    const std::int64_t range = std::array{1, 2, 3, 5, 10}[random.between(0, 4)];
    const std::int64_t depth =
        random.between(0, 3) == 0 ? 0 : range;  // a quarter of them in one plane
    std::vector<LatticePoint> points;
    for (int v = 0; v < 6; ++v)
      points.push_back({random.between(-range, range), random.between(-range, range),
                        random.between(-depth, depth)});
    // Corners of b: first those shared with a, then others; sometimes one twice.
    const auto shared =
        static_cast<std::uint32_t>(random.between(0, 20) == 0 ? 3 : random.between(0, 2));
    Triangle a{0, 1, 2}, b{3 - shared, 4 - shared, 5 - shared};
    if (random.between(0, 19) == 0) a[random.between(0, 2)] = a[random.between(0, 2)];
    if (random.between(0, 19) == 0) b[random.between(0, 2)] = b[random.between(0, 2)];
    for (Triangle* t : {&a, &b}) {
      std::rotate(t->begin(), t->begin() + random.between(0, 2), t->end());
      if (random.between(0, 1) == 0) std::swap((*t)[0], (*t)[1]);
    }
    const bool intersect = slow_intersect_beyond_shared_simplex(points, a, b);
    const std::vector<Vec3> positions = to_positions(points, 1, {0.5, 1000, -3});
    ++seen[shared][intersect];
    const auto description = [&] {
      std::string text;
      for (const Triangle& t : {a, b}) {
        for (const std::uint32_t v : t)
          text += std::to_string(v) + " (" + std::to_string(points[v][0]) + " " +
                  std::to_string(points[v][1]) + " " + std::to_string(points[v][2]) + ") ";
        text += "; ";
      }
      return text;
    };
    ASSERT_EQ(intersect_beyond_shared_simplex(positions, a, b), intersect) << description();
    ASSERT_EQ(intersect_beyond_shared_simplex(positions, b, a), intersect) << description();
  }
  for (std::size_t shared = 0; shared < 3; ++shared)
    for (const std::size_t count : seen[shared]) EXPECT_GT(count, 5'000u) << shared;
}

// Up to eight triangles over few lattice points, like the surfels of a grid cell.
TEST(TrianglePairRandom, CountEqualsThatOfEachPair) {
  Random random(5);
  std::array<std::size_t, 4> seen{};  // by number of pairs, 3 or more in the last
  for (int round = 0; round < 20'000; ++round) {
    std::vector<Vec3> positions;
    const std::int64_t range = std::array{2, 5, 20}[random.between(0, 2)];
    for (int v = 0; v < 9; ++v)
      positions.push_back({static_cast<double>(random.between(-range, range)),
                           static_cast<double>(random.between(-range, range)),
                           static_cast<double>(random.between(-range, range))});
    std::vector<Triangle> triangles;
    for (std::int64_t t = random.between(2, 8); t > 0; --t) {
      const auto first = static_cast<std::uint32_t>(random.between(0, 6));
      triangles.push_back({first, first + static_cast<std::uint32_t>(random.between(1, 2)),
                           static_cast<std::uint32_t>(random.between(0, 8))});
    }
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i)
      for (std::size_t j = i + 1; j < triangles.size(); ++j)
        pairs += intersect_beyond_shared_simplex(positions, triangles[i], triangles[j]);
    ++seen[std::min<std::size_t>(pairs, 3)];
    ASSERT_EQ(count_intersecting_pairs(positions, triangles, 100), pairs);
    ASSERT_EQ(count_intersecting_pairs(positions, triangles, 2), std::min<std::size_t>(pairs, 2));
  }
  for (const std::size_t count : seen) EXPECT_GT(count, 500u);
}

}  // namespace
}  // namespace isoatlas::detail
