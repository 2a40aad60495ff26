// SPDX-License-Identifier: Apache-2.0
#include "core/slack_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "core/epoch_set.h"

namespace isoatlas::detail {
namespace {

// Thousands of changes, so that rows move and the array is compacted many times.
TEST(SlackRows, EqualVectorsOfVectors) {
  std::mt19937 random(5);
  const auto below = [&](std::size_t n) { return static_cast<std::uint32_t>(random() % n); };
  std::vector<std::vector<int>> wanted(20);
  SlackRows<int> rows;
  rows.reserve(std::vector<std::uint32_t>(20, 3));
  for (int step = 0; step < 200'000; ++step) {
    const std::uint32_t r = below(wanted.size());
    switch (below(8)) {
      case 0:
        if (wanted.size() < 300) {
          rows.add_rows(2);
          wanted.resize(wanted.size() + 2);
        } else {
          wanted.resize(20 + below(280));
          rows.resize_rows(wanted.size());
          continue;
        }
        break;
      case 1: {
        std::vector<int> items(below(30));
        std::generate(items.begin(), items.end(), [&] { return static_cast<int>(below(50)); });
        rows.assign(r, items);
        wanted[r] = items;
        break;
      }
      case 2:
      case 3: {
        const auto item = static_cast<int>(below(50));
        rows.erase(r, item);
        if (const auto at = std::find(wanted[r].begin(), wanted[r].end(), item);
            at != wanted[r].end())
          wanted[r].erase(at);
        break;
      }
      default:
        rows.push_back(r, step % 50);
        wanted[r].push_back(step % 50);
    }
    ASSERT_TRUE(std::ranges::equal(rows.row(r), wanted[r])) << step;
    if (step % 1000 != 0) continue;
    ASSERT_EQ(rows.row_count(), wanted.size());
    for (std::uint32_t k = 0; k < wanted.size(); ++k)
      ASSERT_TRUE(std::ranges::equal(rows.row(k), wanted[k])) << step << " row " << k;
  }
}

TEST(EpochSet, ClearsInConstantTime) {
  EpochSet set;
  EXPECT_TRUE(set.insert(70));
  EXPECT_FALSE(set.insert(70));
  EXPECT_TRUE(set.contains(70));
  EXPECT_FALSE(set.contains(69));
  EXPECT_FALSE(set.contains(1'000'000));
  set.clear();
  EXPECT_FALSE(set.contains(70));
  EXPECT_TRUE(set.insert(70));
}

}  // namespace
}  // namespace isoatlas::detail
