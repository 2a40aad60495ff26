// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/hierarchy.h"

#include <gtest/gtest.h>

#include "isoatlas/error.h"

namespace isoatlas::detail {
namespace {

TEST(Hierarchy, LevelOfAVertexIsTheFirstThatHasIt) {
  Hierarchy hierarchy;
  EXPECT_THROW(hierarchy.level_of(0), Error);
  hierarchy.levels = {{4, {}, {}, {}}, {4, {}, {}, {}}, {9, {}, {}, {}}};
  EXPECT_EQ(hierarchy.level_of(0), 0U);
  EXPECT_EQ(hierarchy.level_of(3), 0U);
  EXPECT_EQ(hierarchy.level_of(4), 2U);
  EXPECT_EQ(hierarchy.level_of(8), 2U);
  EXPECT_THROW(hierarchy.level_of(9), Error);
}

}  // namespace
}  // namespace isoatlas::detail
