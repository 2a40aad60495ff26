// SPDX-License-Identifier: Apache-2.0
// Output files that appear together or not at all.
#pragma once

#include <filesystem>
#include <mutex>
#include <vector>

#include "isoatlas/error.h"

namespace isoatlas::detail {

/// Throws Error(bad_file) unless a file could be put at `path` now: its folder exists and takes
/// files, and nothing but a regular file is there. Tried by doing, because permission bits say
/// little about root or read-only mounts.
void check_output_path(const std::filesystem::path& path);

/// The place itself when `path` is a link to it, absolute: renaming onto a link would replace the
/// link.
std::filesystem::path resolved(const std::filesystem::path& path);

/// `path` where it will really be, as people know it: files that belong to it go beside that place.
std::filesystem::path target_of(const std::filesystem::path& path);

/// Are these one file? Links are followed; neither needs to exist. An empty path is no file.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Collects outputs in hidden folders beside their destinations and moves them there in one go.
///
/// Everything unfinished, temporary files of the writers included, lies in those folders, so
/// removing them removes every trace. discard() may be called from another thread while files are
/// being written.
class OutputFiles {
 public:
  OutputFiles() = default;
  ~OutputFiles() { discard(); }
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// Calls work(staged path); what goes wrong there is said of `destination`: nobody knows the
  /// hidden folder.
  template <class Work>
  auto write(const std::filesystem::path& destination, Work work) {
    const std::filesystem::path staged = stage(destination);
    try {
      return work(staged);
    } catch (const Error& error) {
      throw renamed(error, staged, destination);
    }
  }

  /// Where to write what is to end up at `destination`: same file name, in a new folder beside it.
  /// Folders that are made beside the staged file end up beside the destination; of one that is
  /// already there only files of the same name are replaced.
  std::filesystem::path stage(const std::filesystem::path& destination);

  /// Moves all staged files to their destinations. Throws Error(bad_file), and then everything is
  /// as it was before.
  void commit();

  void discard() noexcept;

 private:
  struct Staged {
    std::filesystem::path folder, destination;
    std::filesystem::path file() const { return folder / destination.filename(); }
  };
  struct Move {
    std::filesystem::path from, to, backup;
  };
  static std::vector<Move> moves_of(const Staged& staged);
  static Error renamed(const Error& error, const std::filesystem::path& staged,
                       const std::filesystem::path& destination);
  std::mutex mutex_;
  std::vector<Staged> staged_;
  bool discarded_ = false;
};

}  // namespace isoatlas::detail
