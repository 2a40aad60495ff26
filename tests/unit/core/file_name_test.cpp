// SPDX-License-Identifier: Apache-2.0
#include "core/file_name.h"

#include <gtest/gtest.h>

namespace isoatlas::detail {
namespace {

TEST(FileName, OnlyAsciiLettersChangeCase) {
  EXPECT_EQ(lower_case("Scan_01.NII.Gz"), "scan_01.nii.gz");
  EXPECT_EQ(lower_case("\xC3\x84 [\\]"),
            "\xC3\x84 [\\]");  // a letter of two bytes, and what lies between Z and a
  EXPECT_EQ(lower_case(""), "");
}

TEST(FileName, TheLastExtensionCounts) {
  EXPECT_EQ(lower_case_extension("a.b/Scan.Nii.GZ"), ".gz");
  EXPECT_EQ(lower_case_extension("a.b/Scan"), "");
  EXPECT_EQ(lower_case_extension(".hidden"), "");
}

TEST(FileName, AnyOfTheExtensionsEndsTheName) {
  EXPECT_TRUE(has_extension("a/Scan.NII.GZ", ".nii .nii.gz"));
  EXPECT_TRUE(has_extension("a/scan.nii", ".nii .nii.gz"));
  EXPECT_FALSE(has_extension("a.nii/scan.gz", ".nii .nii.gz"));
  EXPECT_FALSE(has_extension("scan", ".nii .nii.gz"));
  EXPECT_FALSE(has_extension("scan.nii", ""));
}

}  // namespace
}  // namespace isoatlas::detail
