// SPDX-License-Identifier: Apache-2.0
#include "geometry/triangle_bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using test::Random;

struct Soup {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
};

// Triangles of very different sizes about a few points, some without area, some twice.
Soup random_soup(std::uint64_t seed, std::uint32_t triangles, double scale, Vec3 middle) {
  Random random(seed);
  const auto near = [&](Vec3 c, double s) {
    return c + s * Vec3{random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5};
  };
  Soup soup;
  while (soup.triangles.size() < triangles) {
    const auto n = static_cast<std::uint32_t>(soup.positions.size());
    const Vec3 c = near(middle, scale);
    const double size = scale * std::pow(10.0, static_cast<double>(random.between(-4, 0)));
    for (int k = 0; k < 3; ++k) soup.positions.push_back(near(c, size));
    switch (random.between(0, 9)) {
      case 0:
        soup.triangles.push_back({n, n, n});
        break;
      case 1:
        soup.triangles.push_back({n, n + 1, n});
        break;
      case 2:
        soup.positions[n + 2] = 0.5 * (soup.positions[n] + soup.positions[n + 1]);
        soup.triangles.push_back({n, n + 1, n + 2});
        break;
      case 3:
        if (!soup.triangles.empty()) soup.triangles.push_back(soup.triangles.front());
        break;
      default:
        soup.triangles.push_back({n, n + 1, n + 2});
    }
  }
  return soup;
}

TriangleBvh::Hit slow_closest(const Soup& soup, Vec3 p) {
  TriangleBvh::Hit best;
  best.squared_distance = INFINITY;
  for (std::uint32_t t = 0; t < soup.triangles.size(); ++t) {
    const auto [a, b, c] = soup.triangles[t];
    const TrianglePoint found =
        closest_on_triangle(p, soup.positions[a], soup.positions[b], soup.positions[c]);
    if (found.squared_distance < best.squared_distance) {
      static_cast<TrianglePoint&>(best) = found;
      best.triangle = t;
    }
  }
  return best;
}

TEST(TriangleBvh, SameAsTestingAll) {
  for (const std::uint32_t n : {1u, 2u, 3u, 4u, 5u, 15u, 16u, 17u, 64u, 65u, 257u, 1500u}) {
    for (const auto& [scale, middle] :
         {std::pair(1.0, Vec3{}), std::pair(300.0, Vec3{1e4, -2e4, 0}), std::pair(1e15, Vec3{}),
          std::pair(1e-9, Vec3{}), std::pair(1.0, Vec3{1e6, 1e6, 1e6})}) {
      const Soup soup = random_soup(n, n, scale, middle);
      const TriangleBvh bvh(soup.positions, soup.triangles);
      Random random(n + 1);
      for (int k = 0; k < 60; ++k) {
        const double spread = k % 3 == 0 ? 1e3 : k % 3 == 1 ? 2 : 0.5;
        Vec3 p = middle + spread * scale *
                              Vec3{random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5};
        if (k % 10 == 9) p = soup.positions[random.bits() % soup.positions.size()];
        const TriangleBvh::Hit found = bvh.closest(p), slow = slow_closest(soup, p);
        ASSERT_EQ(found.triangle, slow.triangle) << n << " " << scale << " " << k;
        ASSERT_EQ(found.squared_distance, slow.squared_distance);
        ASSERT_EQ(found.point, slow.point);
        ASSERT_EQ(found.weight, slow.weight);
        // A bound equal to the distance still finds it, one below does not.
        const double d = std::sqrt(slow.squared_distance);
        EXPECT_EQ(bvh.closest(p, d * (1 + 1e-12)).triangle, slow.triangle);
        if (d > 0) {
          EXPECT_FALSE(bvh.closest(p, d * (1 - 1e-12)).found());
        }
      }
    }
  }
}

TEST(TriangleBvh, EqualDistancesGoToTheSmallestId) {
  // A fan of triangles about the origin, each listed many times.
  Soup soup;
  soup.positions = {{0, 0, 0}};
  for (int k = 0; k < 12; ++k)
    soup.positions.push_back({std::cos(k * M_PI / 6), std::sin(k * M_PI / 6), 0});
  for (int copy = 0; copy < 50; ++copy) {
    for (std::uint32_t k = 0; k < 12; ++k) soup.triangles.push_back({0, 1 + k, 1 + (k + 1) % 12});
  }
  const TriangleBvh bvh(soup.positions, soup.triangles);
  EXPECT_EQ(bvh.closest({0, 0, 2}).triangle, 0u);
  EXPECT_EQ(bvh.closest({0, 0, 2}, 2).triangle, 0u);
  for (std::uint32_t k = 0; k < 12; ++k) {
    const double angle = (k + 0.5) * M_PI / 6;
    EXPECT_EQ(bvh.closest({0.5 * std::cos(angle), 0.5 * std::sin(angle), 1}).triangle, k);
  }
}

// Every triangle whose box overlaps a box is in a leaf near it, and few others are.
TEST(TriangleBvh, LeavesNearABox) {
  for (const std::uint32_t size : {1u, 4u, 5u, 33u, 3000u}) {
    const double scale = size % 2 == 0 ? 1 : 1e9;
    const Soup soup = random_soup(size, size, scale, {3 * scale, -5 * scale, 1000 * scale});
    const TriangleBvh bvh(soup.positions, soup.triangles);
    ASSERT_EQ(bvh.leaf_count(), (size + 3) / 4);
    std::size_t overlapping = 0, tested = 0;
    for (std::uint32_t t = 0; t < size; ++t) {
      const auto box = [&](const Triangle& triangle) {
        std::array<Vec3, 2> out{soup.positions[triangle[0]], soup.positions[triangle[0]]};
        for (const std::uint32_t v : triangle) {
          const Vec3 p = soup.positions[v];
          out[0] = {std::min(out[0].x, p.x), std::min(out[0].y, p.y), std::min(out[0].z, p.z)};
          out[1] = {std::max(out[1].x, p.x), std::max(out[1].y, p.y), std::max(out[1].z, p.z)};
        }
        return out;
      };
      const auto [low, high] = box(soup.triangles[t]);
      const std::uint32_t first = t % 3 == 0 ? 0 : t % bvh.leaf_count();
      std::vector<std::uint32_t> leaves;
      bvh.leaves_near(low, high, first, leaves);
      std::vector<int> near(bvh.leaf_count(), 0);
      for (const std::uint32_t leaf : leaves) {
        ASSERT_LT(leaf, bvh.leaf_count());
        ASSERT_GE(leaf, first);
        ASSERT_EQ(near[leaf]++, 0);
        tested += bvh.leaf_end(leaf) - TriangleBvh::kLeafSize * leaf;
      }
      for (std::uint32_t slot = TriangleBvh::kLeafSize * first; slot < size; ++slot) {
        const auto [other_low, other_high] = box(bvh.corners_in(slot));
        const bool overlaps = low.x <= other_high.x && other_low.x <= high.x &&
                              low.y <= other_high.y && other_low.y <= high.y &&
                              low.z <= other_high.z && other_low.z <= high.z;
        if (!overlaps) continue;
        ++overlapping;
        ASSERT_EQ(near[slot / TriangleBvh::kLeafSize], 1);
      }
    }
    if (size > 1000) {
      EXPECT_LT(tested, 10 * overlapping + 40 * size);
    }
  }
}

TEST(TriangleBvh, Empty) {
  const TriangleBvh bvh({}, {});
  EXPECT_FALSE(bvh.closest({1, 2, 3}).found());
  std::vector<std::uint32_t> leaves;
  bvh.leaves_near({0, 0, 0}, {1, 1, 1}, 0, leaves);
  EXPECT_TRUE(leaves.empty());
  EXPECT_EQ(bvh.triangle_count(), 0u);
}

TEST(TriangleBvh, EverySlotOnceAndNeighboursClose) {
  const Soup soup = random_soup(9, 3000, 1, {});
  const TriangleBvh bvh(soup.positions, soup.triangles);
  std::vector<int> seen(soup.triangles.size(), 0);
  double along = 0, as_listed = 0;
  for (std::uint32_t s = 0; s < bvh.triangle_count(); ++s) {
    ++seen[bvh.triangle_in(s)];
    EXPECT_EQ(bvh.corners_in(s), soup.triangles[bvh.triangle_in(s)]);
    if (s == 0) continue;
    along += length(bvh.points()[bvh.corners_in(s)[0]] - bvh.points()[bvh.corners_in(s - 1)[0]]);
    as_listed +=
        length(soup.positions[soup.triangles[s][0]] - soup.positions[soup.triangles[s - 1][0]]);
  }
  EXPECT_EQ(seen, std::vector<int>(soup.triangles.size(), 1));
  EXPECT_LT(along, 0.3 * as_listed);
}

TEST(TriangleBvh, SameForAnyNumberOfThreads) {
  const Soup soup = random_soup(5, 20000, 1, {});
  const auto order = [&](int threads) {
    const ThreadLimit limit(threads);
    const TriangleBvh bvh(soup.positions, soup.triangles);
    std::vector<std::uint32_t> out;
    for (std::uint32_t s = 0; s < bvh.triangle_count(); ++s) out.push_back(bvh.triangle_in(s));
    return out;
  };
  EXPECT_EQ(order(1), order(2));
  EXPECT_EQ(order(1), order(3));
}

}  // namespace
}  // namespace isoatlas::detail
