// SPDX-License-Identifier: Apache-2.0
#include "files/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "isoatlas/io.h"
#include "support/file_test_support.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;

TEST(AtomicFile, AppearsWithCommitOnly) {
  const TempFolder folder;
  {
    io::AtomicFile file(folder / "a.txt");
    file.stream() << "whole";
    EXPECT_FALSE(fs::exists(folder / "a.txt"));
    file.commit();
  }
  EXPECT_EQ(read_bytes(folder / "a.txt"), "whole");
  EXPECT_EQ(folder.file_count(), 1U);
}

TEST(AtomicFile, LeavesNothingWithoutCommit) {
  const TempFolder folder;
  write_bytes(folder / "a.txt", "old");
  try {
    io::AtomicFile file(folder / "a.txt");
    file.stream() << "half";
    throw 1;
  } catch (int) {
  }
  EXPECT_EQ(read_bytes(folder / "a.txt"), "old");
  EXPECT_EQ(folder.file_count(), 1U);
}

TEST(AtomicFile, ReplacesAFileAndKeepsALink) {
  const TempFolder folder;
  write_bytes(folder / "target.txt", "old");
  fs::create_symlink("target.txt", folder / "link.txt");
  write_text_file("new", folder / "link.txt");
  EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
  EXPECT_EQ(read_bytes(folder / "target.txt"), "new");
  EXPECT_EQ(folder.file_count(), 2U);
}

TEST(AtomicFile, DevicesAreWrittenNotReplaced) {
  write_text_file("nothing", "/dev/null");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(AtomicFile, ReportsWhyItCannotBeWritten) {
  const TempFolder folder;
  fs::create_directory(folder / "sub");
  expect_error(ErrorCode::bad_file, "it is a folder", folder / "sub",
               [&] { write_text_file("x", folder / "sub"); });
  expect_error(ErrorCode::bad_file, "there is no folder", folder / "none/a.txt",
               [&] { write_text_file("x", folder / "none/a.txt"); });
  write_bytes(folder / "file", "x");
  expect_error(ErrorCode::bad_file, "there is no folder", folder / "file/a.txt",
               [&] { write_text_file("x", folder / "file/a.txt"); });
  EXPECT_EQ(folder.file_count(), 2U);
}

TEST(AtomicFile, FolderWithoutPermission) {
  if (::geteuid() == 0) {
    GTEST_SKIP() << "root may write everywhere";
  }
  const TempFolder folder;
  fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
  expect_error(ErrorCode::bad_file, "cannot be written", folder / "a.ply",
               [&] { check_mesh_path(folder / "a.ply"); });
  fs::permissions(folder.path(), fs::perms::owner_all);
}

// Simulates a full disk by a limit on the size of files: write() fails in the same way, half way
// through.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    rlimit limit = old_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit old_{};
  void (*old_handler_)(int) = nullptr;
};

TEST(AtomicFile, FullDiskIsAnErrorAndLeavesNothing) {
  TriangleMesh mesh;
  for (int i = 0; i < 30000; ++i) {
    const double x = i;
    mesh.positions.push_back({x, 0.1 * x, x * x});
  }
  for (std::uint32_t i = 0; i + 2 < 30000; ++i) {
    mesh.triangles.push_back({i, i + 1, i + 2});
  }
  for (const char* name : {"full.ply", "full.stl", "full.obj", "full.off", "full.vtp"}) {
    const TempFolder folder;
    write_bytes(folder / name, "old");
    {
      const FileSizeLimit limit(100000);
      expect_error(ErrorCode::bad_file, "cannot be written", folder / name,
                   [&] { write_mesh(mesh, folder / name); });
    }
    EXPECT_EQ(read_bytes(folder / name), "old");
    EXPECT_EQ(folder.file_count(), 1U) << name;
  }
}

}  // namespace
}  // namespace isoatlas::detail::test
