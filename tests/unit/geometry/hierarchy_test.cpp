// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/hierarchy.h"

#include <gtest/gtest.h>

#include <functional>

#include "isoatlas/error.h"
#include "isoatlas/extract.h"

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

ErrorCode code_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.code();
  }
  return ErrorCode::internal;
}

// std::out_of_range, or a crash, before.
TEST(Hierarchy, MissingLevelsAreBadArguments) {
  const Hierarchy none;
  EXPECT_EQ(code_of([&] { none.mesh(0); }), ErrorCode::bad_argument);
  EXPECT_EQ(code_of([&] { none.view(0); }), ErrorCode::bad_argument);
  EXPECT_EQ(code_of([] { Extraction{}.mesh(); }), ErrorCode::bad_argument);
  EXPECT_EQ(code_of([] { hierarchy_of({}); }), ErrorCode::bad_argument);
  const Hierarchy one = hierarchy_of({TriangleMesh{}});
  EXPECT_EQ(one.mesh(0).positions.size(), 0U);
  EXPECT_EQ(code_of([&] { one.mesh(1); }), ErrorCode::bad_argument);
}

}  // namespace
}  // namespace isoatlas::detail
