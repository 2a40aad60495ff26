// SPDX-License-Identifier: Apache-2.0
// Output files that appear together or not at all.
#pragma once

#include <filesystem>
#include <mutex>
#include <vector>

namespace isoatlas::tool {

/// Throws Error(bad_file) unless a file could be put at `path` now: its folder exists and takes files, and nothing but
/// a regular file is there. Tried by doing, because permission bits say little about root or read-only mounts.
void check_output_path(const std::filesystem::path& path);

/// Are these one file? Links are followed; neither needs to exist.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Collects outputs in hidden folders beside their destinations and moves them there in one go.
///
/// Everything unfinished, temporary files of the writers included, lies in those folders, so removing them removes
/// every trace. discard() may be called from another thread while files are being written.
class OutputFiles {
 public:
  OutputFiles() = default;
  ~OutputFiles() { discard(); }
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// Where to write what is to end up at `destination`: same file name, in a new folder beside it.
  std::filesystem::path stage(const std::filesystem::path& destination);

  /// Moves all staged files to their destinations. Throws Error(bad_file), and then none of them is there.
  void commit();

  void discard() noexcept;

 private:
  struct Staged {
    std::filesystem::path folder, destination;
    std::filesystem::path file() const { return folder / destination.filename(); }
  };
  std::mutex mutex_;
  std::vector<Staged> staged_;
  bool discarded_ = false;
};

}  // namespace isoatlas::tool
