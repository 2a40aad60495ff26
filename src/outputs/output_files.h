// SPDX-License-Identifier: Apache-2.0
// Output files that are created together or not at all.
#pragma once

#include <filesystem>
#include <mutex>
#include <vector>

#include "isoatlas/error.h"

namespace isoatlas::detail {

/// Checks that a file can be created at `path` or replaced there. It creates and removes a folder
/// next to it, because permission bits are not reliable for root and on read-only mounts.
/// @throws Error(bad_file) if the parent folder is missing or not writable, or if `path` exists and
///         is not a regular file
void check_output_path(const std::filesystem::path& path);

/// The absolute path with links resolved. Renaming a file to a link would replace the link.
std::filesystem::path resolved(const std::filesystem::path& path);

/// The file that `path` links to, or `path` itself. Files that belong to it are written next to it.
std::filesystem::path target_of(const std::filesystem::path& path);

/// True if both paths are the same file. Links are followed; the files need not exist. An empty
/// path is never the same.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Collects output files in hidden folders next to their destinations, and moves all of them to
/// their destinations in commit().
///
/// All unfinished files, including temporary files of the writers, are in these folders, so
/// removing the folders removes everything. discard() may be called from another thread while files
/// are written.
class OutputFiles {
 public:
  OutputFiles() = default;
  ~OutputFiles() { discard(); }
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// Calls write_file(staged path) and returns its result. Errors name `destination` instead of the
  /// hidden folder.
  template <class WriteFile>
  auto write(const std::filesystem::path& destination, WriteFile write_file) {
    const std::filesystem::path staged = stage(destination);
    try {
      return write_file(staged);
    } catch (const Error& error) {
      throw renamed(error, staged, destination);
    }
  }

  /// The staged path of a destination: the same file name in a new hidden folder. Folders that are
  /// created next to the staged file, or in its place, are moved with it. If such a folder exists
  /// at the destination, only files of the same name are replaced in it.
  std::filesystem::path stage(const std::filesystem::path& destination);

  /// Moves all staged files to their destinations.
  /// @throws Error(bad_file) if a file cannot be moved; then all moves are reverted
  void commit();

  /// Removes all staged files. stage() throws Error(cancelled) from then on.
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
