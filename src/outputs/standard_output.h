// SPDX-License-Identifier: Apache-2.0
// Standard output as a destination: nothing is sent before all of it is known to be good.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <string_view>

#include "isoatlas/error.h"

namespace isoatlas::detail {

inline constexpr const char* kStandardOutputName = "standard output";  ///< what messages call it

/// The name that stands for standard output, and for standard input, on a command line.
bool is_standard_stream(const std::filesystem::path& path);

/// A file under a temporary name that is sent when it is done.
class StandardOutputFile {
 public:
  /// @param name  of the file, in a temporary folder of its own
  /// @throws Error(bad_file) if there is no room for temporary files
  explicit StandardOutputFile(const std::string& name);
  ~StandardOutputFile() { discard(); }
  StandardOutputFile(const StandardOutputFile&) = delete;
  StandardOutputFile& operator=(const StandardOutputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// The error as one about standard output: nobody knows the temporary name.
  Error renamed(const Error& error) const;

  /// The whole file, as send_to_standard_output() has it.
  bool send(const std::atomic<bool>& cancel) const;

  /// Removes the file; may be called from another thread.
  void discard() noexcept;

 private:
  std::filesystem::path path_;
};

/// Writes all bytes to standard output, past any buffer of a stream. @return false if `cancel`
/// became true before all were taken
/// @throws Error(bad_file) if nobody takes them: a full disk, or a pipe that was closed, which does
/// not raise a signal here
bool send_to_standard_output(std::string_view bytes, const std::atomic<bool>& cancel);

}  // namespace isoatlas::detail
