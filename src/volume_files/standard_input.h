// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace isoatlas::detail::io {

/// Standard input as a file: readers need to go back and forth. The file has no name that others
/// see before it is gone.
class StandardInput {
 public:
  /// Reads standard input to its end. @throws Error(bad_file) if it is empty or cannot be read or
  /// kept
  StandardInput();
  ~StandardInput();
  StandardInput(const StandardInput&) = delete;
  StandardInput& operator=(const StandardInput&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  int descriptor_ = -1;
  std::filesystem::path path_;
};

/// What messages call it.
inline constexpr const char* kStandardInputName = "standard input";

}  // namespace isoatlas::detail::io
