// SPDX-License-Identifier: Apache-2.0
#include "nearest_name.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace isoatlas::detail::tool {
namespace {

TEST(EditDistance, CountsLettersAndSwaps) {
  EXPECT_EQ(edit_distance("", ""), 0U);
  EXPECT_EQ(edit_distance("abc", ""), 3U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("extract", "extract"), 0U);
  EXPECT_EQ(edit_distance("extrat", "extract"), 1U);    // left out
  EXPECT_EQ(edit_distance("exttract", "extract"), 1U);  // added
  EXPECT_EQ(edit_distance("extrakt", "extract"), 1U);   // changed
  EXPECT_EQ(edit_distance("extarct", "extract"), 1U);   // swapped
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
}

TEST(NearestName, IsTheOneWithTheFewestDifferences) {
  const std::vector<std::string> names{"iso",          "max-distance", "max-vertices",
                                       "min-vertices", "space",        "spacing"};
  EXPECT_EQ(nearest_name("is", names), "iso");
  EXPECT_EQ(nearest_name("max-vertice", names), "max-vertices");
  EXPECT_EQ(nearest_name("min-vertex", names), "min-vertices");
  EXPECT_EQ(nearest_name("MAX_DISTANCE", names), "max-distance");
  EXPECT_EQ(nearest_name("spaces", names), "space");
  EXPECT_EQ(nearest_name("spacin", names), "spacing");
}

TEST(NearestName, IsTheOnlyNameWithAPrefix) {
  const std::vector<std::string> names{"max-distance", "max-vertices", "supersample"};
  EXPECT_EQ(nearest_name("max-d", names), "max-distance");
  EXPECT_EQ(nearest_name("super", names), "supersample");
  EXPECT_EQ(nearest_name("max", names), "") << "two names have this prefix";
  EXPECT_EQ(nearest_name("su", names), "") << "too short";
}

TEST(NearestName, IsEmptyIfNoNameIsSimilar) {
  const std::vector<std::string> names{"iso", "refine", "o"};
  for (const char* typed : {"", "x", "frobnicate", "or", "close"})
    EXPECT_EQ(nearest_name(typed, names), "") << typed;
}

}  // namespace
}  // namespace isoatlas::detail::tool
