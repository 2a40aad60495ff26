// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <ostream>

namespace isoatlas::detail::io {

/// A file that appears whole or not at all. It is written under a temporary name in the
/// destination's folder; commit() renames it over the destination. Without commit() (after an
/// exception or an early return) the temporary file is removed and the destination is unchanged.
///
/// A destination that exists and is not a regular file (/dev/null, a pipe) is written directly: it
/// must not be replaced.
class AtomicFile {
 public:
  /// @throws Error(bad_file) if the folder does not exist or cannot be written, or if the
  /// destination is a folder or write protected
  explicit AtomicFile(const std::filesystem::path& destination);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// The stream to write to. The caller need not check it for errors: commit() does.
  std::ostream& stream() { return stream_; }

  /// The name to write to, for a library that opens its files itself. Use this or stream(), not
  /// both.
  const std::filesystem::path& written_path() const { return written_path_; }

  /// Makes all bytes written to stream() so far readable at written_path(). Throws Error(bad_file).
  void flush();

  /// True if commit() renames the file into place. False for a device or a pipe, which cannot be
  /// read back.
  bool is_temporary() const { return written_path_ != target_; }

  /// The path that the user gave, for messages.
  const std::filesystem::path& destination() const { return destination_; }

  /// Flushes the file to disk and renames it. Throws Error(bad_file), e.g. if the disk is full.
  void commit();

 private:
  std::filesystem::path destination_;
  std::filesystem::path target_;  // destination with symbolic links resolved: a link stays a link
  std::filesystem::path written_path_;
  std::ofstream stream_;
  bool committed_ = false;
};

}  // namespace isoatlas::detail::io
