// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include "isoatlas/export.h"

namespace isoatlas {

/// What went wrong. Each code has one exit status of the tool (docs/reference/errors.md).
enum class ErrorCode {
  bad_argument,   ///< an option or a parameter is out of its domain            exit 2
  bad_file,       ///< a file is missing, truncated, malformed or not writable  exit 2
  unsupported,    ///< a file is well formed but not what isoatlas meshes       exit 2
  empty_surface,  ///< there is no isosurface at this isovalue                  exit 2
  internal,       ///< isoatlas' own check failed; nothing was written          exit 3
  out_of_memory,  ///< an allocation failed                                     exit 4
  cancelled,      ///< the caller asked to stop                                 exit 130
};

/// The one exception type of the library. what() is one line: what, where, what was expected.
class ISOATLAS_API Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace isoatlas
