// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <ostream>

namespace isoatlas::detail::io {

/// A file that appears whole or not at all: written under a temporary name in the destination's
/// folder, renamed over the destination by commit(). Without commit() (an exception, an early
/// return) the temporary file is removed and whatever was at the destination is untouched.
///
/// A destination that exists and is no regular file (/dev/null, a pipe) is written directly: it
/// must not be replaced.
class AtomicFile {
 public:
  /// @throws Error(bad_file) if the folder does not exist or cannot be written, or the destination
  /// is a folder or
  ///         write protected
  explicit AtomicFile(const std::filesystem::path& destination);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Where the bytes go. Errors may be left for commit() to find.
  std::ostream& stream() { return stream_; }

  /// The name to write to, for a library that opens its files itself. Use this or stream(), not
  /// both.
  const std::filesystem::path& written_path() const { return written_path_; }

  /// Everything put into stream() so far can be read at written_path(). Throws Error(bad_file).
  void flush();

  /// Will the bytes be renamed into place? Not those that go to a device or a pipe, which cannot be
  /// read back.
  bool is_temporary() const { return written_path_ != target_; }

  /// What the user called the file: for messages.
  const std::filesystem::path& destination() const { return destination_; }

  /// Flushes to the disk and renames. Throws Error(bad_file), e.g. when the disk is full.
  void commit();

 private:
  std::filesystem::path destination_;
  std::filesystem::path target_;  // destination with links followed: a link stays a link
  std::filesystem::path written_path_;
  std::ofstream stream_;
  bool committed_ = false;
};

}  // namespace isoatlas::detail::io
