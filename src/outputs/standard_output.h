// SPDX-License-Identifier: Apache-2.0
// Writes to standard output. Nothing is sent before the whole output is complete and checked.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <string_view>

#include "isoatlas/error.h"

namespace isoatlas::detail {

inline constexpr const char* kStandardOutputName = "standard output";  ///< for messages

/// True for "-", which means standard output or standard input on a command line.
bool is_standard_stream(const std::filesystem::path& path);

/// A temporary file that is sent to standard output when it is complete.
class StandardOutputFile {
 public:
  /// @param name  the name of the file in a new temporary folder
  /// @throws Error(bad_file) if the temporary folder cannot be created
  explicit StandardOutputFile(const std::string& name);
  ~StandardOutputFile() { discard(); }
  StandardOutputFile(const StandardOutputFile&) = delete;
  StandardOutputFile& operator=(const StandardOutputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// The error with "standard output" in place of the temporary path.
  Error renamed(const Error& error) const;

  /// Sends the whole file, see send_to_standard_output().
  bool send(const std::atomic<bool>& cancel) const;

  /// Removes the file; may be called from another thread.
  void discard() noexcept;

 private:
  std::filesystem::path path_;
};

/// Writes all bytes to standard output, without the buffer of a stream.
/// @return false if `cancel` became true before all bytes were written
/// @throws Error(bad_file) if writing fails: the disk is full, or the pipe is closed (SIGPIPE is
///         ignored)
bool send_to_standard_output(std::string_view bytes, const std::atomic<bool>& cancel);

}  // namespace isoatlas::detail
