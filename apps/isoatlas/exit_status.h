// SPDX-License-Identifier: Apache-2.0
// The exit statuses of the tool; docs/reference/errors.md explains them.
#pragma once

#include "isoatlas/error.h"

namespace isoatlas::detail::tool {

inline constexpr int kSuccess = 0;
/// `isoatlas check` and `levels`: a mesh is not a consistently oriented manifold, has
/// self-intersections, or is nowhere near its volume.
inline constexpr int kCheckFailed = 1;
/// `isoatlas extract`: a requested constraint is violated, a mesh has self-intersections, or a
/// component is inverted or inside the wrong component. Everything was written; with --strict
/// nothing.
inline constexpr int kUnsatisfied = 1;
inline constexpr int kBadInput = 2;     ///< invalid argument or file; nothing was written
inline constexpr int kInternal = 3;     ///< a bug of isoatlas; nothing was written
inline constexpr int kOutOfMemory = 4;  ///< nothing was written
/// The status of an interrupted run is this plus the number of the signal, as in shells.
inline constexpr int kSignalBase = 128;

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
      return kSignalBase + 2;  // SIGINT; Interruption::exit_status() has the actual signal
  }
  return kInternal;
}

}  // namespace isoatlas::detail::tool
