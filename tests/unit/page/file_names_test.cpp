// SPDX-License-Identifier: Apache-2.0
#include "page/file_names.h"

#include <gtest/gtest.h>

namespace isoatlas::detail::page {
namespace {

TEST(FileNames, AreTheLastPartsOfPaths) {
  EXPECT_EQ(file_name("/data/Jane Doe/scan.nrrd"), "scan.nrrd");
  EXPECT_EQ(file_name("scan.nrrd"), "scan.nrrd");
  EXPECT_EQ(file_name("../series/"), "series");
  EXPECT_EQ(file_name("-"), "-");
  EXPECT_EQ(file_name(""), "");
}

TEST(FileNames, ReplaceThePathsOfACommand) {
  EXPECT_EQ(with_file_names("isoatlas extract /p/doe/a.nrrd --iso 80.5 -o /p/doe/a.glb "
                            "--report ../a.json --html=/www/a.html -q",
                            "/p/doe/a.nrrd"),
            "isoatlas extract a.nrrd --iso 80.5 -o a.glb --report a.json --html=a.html -q");
  EXPECT_EQ(with_file_names("isoatlas extract series/ -oout/a.ply --iso 1", "series/"),
            "isoatlas extract series -oa.ply --iso 1");
  EXPECT_EQ(with_file_names("isoatlas extract '/p/it'\\''s me/a b.nrrd' '--output=/p q/c.ply'",
                            "/p/it's me/a b.nrrd"),
            "isoatlas extract 'a b.nrrd' --output=c.ply");
}

TEST(FileNames, KeepOtherWords) {
  // Slashes in the name of an array are not those of a path.
  const std::string command =
      "isoatlas extract a.vti --array 'p/q r' --iso 1 --refine "
      "max-distance:2vx,max-vertices:10 -o -";
  EXPECT_EQ(with_file_names(command, "a.vti"), command);
  EXPECT_EQ(with_file_names("", "a.vti"), "");
}

}  // namespace
}  // namespace isoatlas::detail::page
