// SPDX-License-Identifier: Apache-2.0
// The exit statuses of the tool; docs/reference/errors.md explains them.
#pragma once

#include "isoatlas/error.h"

namespace isoatlas::detail::tool {

inline constexpr int kSuccess = 0;
/// `isoatlas check` and `levels`: not a consistently oriented manifold, one that meets itself, or
/// far from its volume.
inline constexpr int kCheckFailed = 1;
/// `isoatlas extract`: a constraint that was asked for is not met, triangles meet or components are
/// misplaced; everything was written, with
/// --strict nothing.
inline constexpr int kUnmet = 1;
inline constexpr int kBadInput = 2;     ///< an argument or a file; nothing was written
inline constexpr int kInternal = 3;     ///< a bug of isoatlas; nothing was written
inline constexpr int kOutOfMemory = 4;  ///< nothing was written
inline constexpr int kSignalBase =
    128;  ///< interrupted: this plus the signal's number, as shells have it

inline int exit_status(ErrorCode code) {
  switch (code) {
    case ErrorCode::bad_argument:
    case ErrorCode::bad_file:
    case ErrorCode::unsupported:
    case ErrorCode::empty_surface:
      return kBadInput;
    case ErrorCode::internal:
      return kInternal;
    case ErrorCode::out_of_memory:
      return kOutOfMemory;
    case ErrorCode::cancelled:
      return kSignalBase + 2;  // SIGINT, unless the caller knows better
  }
  return kInternal;
}

}  // namespace isoatlas::detail::tool
