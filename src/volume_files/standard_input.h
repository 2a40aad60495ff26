// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace isoatlas::detail::io {

/// Copies standard input to a file, because readers need random access. The file is unlinked at
/// once, so it never outlives the process.
class StandardInput {
 public:
  /// Reads standard input to its end. @throws Error(bad_file) if it is empty or cannot be read or
  /// stored
  StandardInput();
  ~StandardInput();
  StandardInput(const StandardInput&) = delete;
  StandardInput& operator=(const StandardInput&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  int descriptor_ = -1;
  std::filesystem::path path_;
};

/// The name of standard input in messages.
inline constexpr const char* kStandardInputName = "standard input";

}  // namespace isoatlas::detail::io
