// SPDX-License-Identifier: Apache-2.0
#include "volume_files/choice.h"

#include <gtest/gtest.h>

namespace isoatlas::detail::io {
namespace {

const FileChoice kChannels{"channel", {"DAPI", "1", "GFP"}, {}};

TEST(Choice, OneEntryNeedsNoOption) {
  VolumeSource source;
  EXPECT_EQ(take_choice("a.tif", source, numbered_choice("time", 1), std::optional<std::size_t>{}),
            0U);
  ASSERT_EQ(source.choices.size(), 1U);
  EXPECT_EQ(source.choices[0].selected, 0U);
}

TEST(Choice, SeveralEntriesNeedOneAndAreListed) {
  VolumeSource source;
  try {
    take_choice("a.tif", source, kChannels, std::optional<std::size_t>{});
    FAIL() << "expected ChoiceNeeded";
  } catch (const ChoiceNeeded& needed) {
    EXPECT_STREQ(needed.what(),
                 "a.tif: has 3 channels, expected a choice of one: 0 (DAPI), 1, 2 (GFP)");
    EXPECT_EQ(needed.choice().name, "channel");
    EXPECT_EQ(needed.source().choices.back().entries.size(), 3U);
    EXPECT_EQ(needed.code(), ErrorCode::unsupported);
  }
}

TEST(Choice, TakesANameOrANumber) {
  VolumeSource source;
  EXPECT_EQ(take_choice("a", source, kChannels, std::string("GFP")), 2U);
  EXPECT_EQ(take_choice("a", source, kChannels, std::string("2")), 2U);
  EXPECT_EQ(take_choice("a", source, kChannels, std::optional<std::size_t>{1}), 1U);
}

TEST(Choice, RefusesMissingEntries) {
  VolumeSource source;
  for (const std::string wanted : {"3", "-1", "RFP", "1x"}) {
    EXPECT_THROW(take_choice("a", source, kChannels, wanted), Error) << wanted;
  }
  EXPECT_THROW(take_choice("a", source, kChannels, std::optional<std::size_t>{3}), Error);
}

}  // namespace
}  // namespace isoatlas::detail::io
