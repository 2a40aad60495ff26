// SPDX-License-Identifier: Apache-2.0
#include "wording/choices.h"

#include <gtest/gtest.h>

#include <string>

#include "isoatlas/error.h"

namespace isoatlas::detail {
namespace {

TEST(Choices, NamesAreParsed) {
  EXPECT_EQ(parse_inside("below"), Inside::below);
  EXPECT_EQ(parse_topology("faces"), Topology::faces);
  EXPECT_EQ(parse_interpolation("tricubic"), Interpolation::tricubic);
  EXPECT_EQ(parse_non_finite("above"), NonFinite::above);
  EXPECT_EQ(parse_space("voxel"), Space::voxel);
  EXPECT_EQ(parse_covering("halving"), CoveringStrategy::halving);
  EXPECT_EQ(parse_placement("balanced"), Placement::balanced);
  EXPECT_TRUE(parse_is_big_endian("big"));
}

TEST(Choices, EverySampleTypeHasAName) {
  for (int i = 0; i <= static_cast<int>(SampleType::float64); ++i)
    EXPECT_EQ(parse_sample_type(name(static_cast<SampleType>(i))), static_cast<SampleType>(i));
}

TEST(Choices, CaseBlanksAndUnderscoresAreIgnored) {
  EXPECT_EQ(parse_space("LPS"), Space::lps);
  EXPECT_EQ(parse_inside(" Below\n"), Inside::below);
  EXPECT_EQ(parse_covering("Sizing_Field"), CoveringStrategy::sizing_field);
}

TEST(Choices, RefusalsListTheNames) {
  for (const char* text : {"", "abov", "a bove", "above,below", "1"}) {
    try {
      parse_inside(text);
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_argument);
      EXPECT_EQ(error.what(), "expected one of above, below, got '" + std::string(text) + "'");
    }
  }
}

}  // namespace
}  // namespace isoatlas::detail
