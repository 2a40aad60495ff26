// SPDX-License-Identifier: Apache-2.0
#include "outputs/output_files.h"

#include <gtest/gtest.h>

#include <utility>

#include "isoatlas/error.h"
#include "support/file_test_support.h"

namespace isoatlas::detail {
namespace {

namespace fs = std::filesystem;
using test::read_bytes;
using test::TempFolder;
using test::write_bytes;

// Writes a file and a folder of files next to it, as for a .vtm.
void write_staged(const fs::path& staged) {
  write_bytes(staged, "new");
  fs::create_directory(staged.parent_path() / "a");
  write_bytes(staged.parent_path() / "a/0", "new 0");
  write_bytes(staged.parent_path() / "a/1", "new 1");
}

TEST(OutputFiles, FoldersNextToAFileAreMovedWithIt) {
  const TempFolder folder;
  {
    OutputFiles outputs;
    write_staged(outputs.stage(folder / "a.vtm"));
    EXPECT_FALSE(fs::exists(folder / "a"));
    outputs.commit();
  }
  EXPECT_EQ(read_bytes(folder / "a.vtm"), "new");
  EXPECT_EQ(read_bytes(folder / "a/0"), "new 0");
  EXPECT_EQ(folder.file_count(), 2U);
}

TEST(OutputFiles, InAnExistingFolderOnlyFilesOfTheSameNameAreReplaced) {
  const TempFolder folder;
  fs::create_directory(folder / "a");
  write_bytes(folder / "a/0", "old 0");
  write_bytes(folder / "a/7", "old 7");
  {
    OutputFiles outputs;
    write_staged(outputs.stage(folder / "a.vtm"));
    outputs.commit();
  }
  EXPECT_EQ(read_bytes(folder / "a/0"), "new 0");
  EXPECT_EQ(read_bytes(folder / "a/1"), "new 1");
  EXPECT_EQ(read_bytes(folder / "a/7"), "old 7");
  EXPECT_EQ(folder.file_count(), 2U);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "a"), {}), 3);
}

TEST(OutputFiles, ErrorsNameTheFileAndNotTheHiddenFolder) {
  const TempFolder folder;
  fs::create_directory(folder / "elsewhere");
  write_bytes(folder / "elsewhere/b.vtm", "old");
  fs::create_symlink("elsewhere/b.vtm", folder / "link.vtm");
  for (const auto& [given, expected] :
       {std::pair("a.vtm", "a.vtm"), std::pair("link.vtm", "elsewhere/b.vtm")}) {
    const fs::path shown = folder / expected;
    OutputFiles outputs;
    try {
      outputs.write(folder / given, [](const fs::path& staged) {
        throw Error(ErrorCode::bad_file, staged.string() + ": bad, as is " +
                                             (staged.parent_path() / "a/a_0.vtp").string());
      });
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_file);
      EXPECT_EQ(error.what(),
                shown.string() + ": bad, as is " + (shown.parent_path() / "a/a_0.vtp").string());
    }
  }
}

TEST(OutputFiles, AFailedCommitRestoresOldFiles) {
  for (const bool has_old : {false, true}) {
    const TempFolder folder;
    if (has_old) {
      fs::create_directory(folder / "a");
      write_bytes(folder / "a/0", "old 0");
      write_bytes(folder / "a.vtm", "old");
    }
    {
      OutputFiles outputs;
      write_staged(outputs.stage(folder / "a.vtm"));
      write_bytes(outputs.stage(folder / "report"), "new");
      // Created after all checks, so that the last rename fails.
      fs::create_directories(folder / "report/in the way");
      EXPECT_THROW(outputs.commit(), Error);
    }
    EXPECT_EQ(fs::exists(folder / "a.vtm"), has_old);
    EXPECT_EQ(fs::exists(folder / "a"), has_old);
    EXPECT_FALSE(fs::exists(folder / "a/1"));
    EXPECT_TRUE(fs::is_directory(folder / "report/in the way"));
    if (has_old) {
      EXPECT_EQ(read_bytes(folder / "a.vtm"), "old");
      EXPECT_EQ(read_bytes(folder / "a/0"), "old 0");
    }
    EXPECT_EQ(folder.file_count(), has_old ? 3U : 1U);
  }
}

TEST(OutputFiles, DiscardLeavesNothing) {
  const TempFolder folder;
  write_bytes(folder / "a.vtm", "old");
  OutputFiles outputs;
  write_staged(outputs.stage(folder / "a.vtm"));
  outputs.discard();
  EXPECT_EQ(read_bytes(folder / "a.vtm"), "old");
  EXPECT_EQ(folder.file_count(), 1U);
  EXPECT_THROW(outputs.stage(folder / "b"), Error);
}

}  // namespace
}  // namespace isoatlas::detail
