// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/disjoint_sets.h"
#include "core/distance_queue.h"
#include "core/ids.h"
#include "core/parallel.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using test::Random;

TEST(DisjointSets, RootIsTheSmallestMemberWhateverTheOrder) {
  Random random(1);
  for (int round = 0; round < 50; ++round) {
    const auto n = static_cast<std::uint32_t>(1 + random.bits() % 60);
    DisjointSets sets(n);
    std::vector<std::uint32_t> label(n);  // the slow way: relabels everything
    for (std::uint32_t i = 0; i < n; ++i) label[i] = i;
    for (std::uint32_t k = 0; k < n; ++k) {
      const auto a = static_cast<std::uint32_t>(random.bits() % n),
                 b = static_cast<std::uint32_t>(random.bits() % n);
      sets.unite(a, b);
      const std::uint32_t to = std::min(label[a], label[b]), from = std::max(label[a], label[b]);
      std::replace(label.begin(), label.end(), from, to);
      for (std::uint32_t i = 0; i < n; ++i) ASSERT_EQ(sets.find(i), label[i]);
    }
  }
}

TEST(DisjointSets, ThreadsThatUniteAtTheSameTimeGetTheSameSets) {
  constexpr std::uint32_t n = 50000;
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    Random random(seed);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs(
        n / 10 * (8 + seed));  // small sets, then a large one
    for (auto& [a, b] : pairs) {
      a = static_cast<std::uint32_t>(random.bits() % n);
      b = static_cast<std::uint32_t>(
          seed % 2 ? random.bits() % n : std::min<std::uint64_t>(n - 1, a + random.bits() % 8));
    }
    DisjointSets alone(n), together(n);
    for (const auto& [a, b] : pairs) alone.unite(a, b);
    for_each_index(pairs.size(), 1,
                   [&](std::size_t i) { together.unite(pairs[i].first, pairs[i].second); });
    for (std::uint32_t i = 0; i < n; ++i) {
      ASSERT_EQ(together.find(i), alone.find(i)) << "seed " << seed;
      ASSERT_EQ(together.is_root(i), together.find(i) == i);
    }
  }
}

TEST(DisjointSets, ResetSplitsAWholeSet) {
  DisjointSets sets(6);
  sets.unite(1, 3);
  sets.unite(3, 5);
  sets.unite(0, 2);
  for (const std::uint32_t i : {1u, 3u, 5u}) sets.reset(i);
  EXPECT_EQ(sets.find(1), 1u);
  EXPECT_EQ(sets.find(3), 3u);
  EXPECT_EQ(sets.find(5), 5u);
  EXPECT_EQ(sets.find(2), 0u);
}

TEST(LengthKey, OrdersByLengthThenId) {
  const float lengths[] = {
      0.0f,  std::numeric_limits<float>::denorm_min(), 1e-30f, 1.0f, std::nextafter(1.0f, 2.0f),
      3e38f, std::numeric_limits<float>::infinity()};
  for (const float a : lengths) {
    for (const float b : lengths) {
      for (const std::uint32_t i : {0u, 7u, kNone}) {
        for (const std::uint32_t j : {0u, 7u, kNone}) {
          EXPECT_EQ(length_key(a, i) < length_key(b, j), a < b || (a == b && i < j));
        }
      }
      EXPECT_EQ(key_length(length_key(a, 5)), a);
    }
  }
  EXPECT_EQ(key_id(length_key(2.5f, 123456u)), 123456u);
}

TEST(KeyHeap, PopsInOrderWithTiesByTheSmallerId) {
  Random random(2);
  NearestFirst near;
  FarthestFirst far;
  std::multiset<std::pair<float, std::uint32_t>> all;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const auto length = static_cast<float>(random.bits() % 20);
    near.push(length_key(length, i));
    far.push(length_key(length, ~i));
    all.insert({length, i});
  }
  EXPECT_EQ(near.size(), 1000u);
  for (const auto& [length, id] : all) {
    const std::uint64_t key = near.pop();
    ASSERT_EQ(key_length(key), length);
    ASSERT_EQ(key_id(key), id);
  }
  EXPECT_TRUE(near.empty());
  std::vector<std::pair<float, std::uint32_t>> backwards(all.begin(), all.end());
  std::stable_sort(backwards.begin(), backwards.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [length, id] : backwards) {
    const std::uint64_t key = far.pop();
    ASSERT_EQ(key_length(key), length);
    ASSERT_EQ(~key_id(key), id);
  }
}

// As in Dijkstra's algorithm: no pushed length is smaller than the last one popped.
TEST(MonotoneQueue, PopsTheShortestAndLosesNothing) {
  Random random(3);
  MonotoneQueue queue;
  for (int run = 0; run < 20; ++run) {
    std::multiset<std::uint64_t> all;
    float last = 0;
    const auto push = [&] {
      const float length =
          last + (random.bits() % 3 ? 1e-3f * static_cast<float>(random.bits() % 5000) : 0);
      const std::uint64_t key =
          length_key(random.bits() % 50 ? length : std::max(last, 1e6f * length),
                     static_cast<std::uint32_t>(random.bits()));
      queue.push(key);
      all.insert(key);
    };
    for (int k = 0; k < 50; ++k) push();
    for (int k = 0; k < 2000 && !queue.empty(); ++k) {
      const std::uint64_t key = queue.pop();
      ASSERT_EQ(key_length(key), key_length(*all.begin()));
      ASSERT_EQ(all.erase(key), 1u);
      last = key_length(key);
      for (std::uint64_t n = random.bits() % 3; n > 0 && k < 1500; --n) push();
    }
    EXPECT_EQ(queue.empty(), all.empty());
    queue.clear();
    EXPECT_TRUE(queue.empty());
  }
}

TEST(CheckedId, RefusesCountsThatDoNotFit) {
  EXPECT_EQ(checked_id(kNone - 1, "things"), kNone - 1);
  try {
    checked_id(std::size_t{kNone}, "things");
    FAIL() << "kNone is not an id";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::unsupported);
    EXPECT_NE(std::string(e.what()).find("things"), std::string::npos);
  }
  EXPECT_THROW(checked_id(std::size_t{1} << 40, "things"), Error);
}

}  // namespace
}  // namespace isoatlas::detail
