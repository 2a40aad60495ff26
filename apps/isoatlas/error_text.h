// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "isoatlas/error.h"

namespace isoatlas::detail::tool {

/// The error as one line, with the command-line options that avoid it.
inline std::string error_text(const Error& error) {
  switch (error.remedy()) {
    case Remedy::place_nan:
      return error.problem() +
             ": use --nan below or --nan above to choose the side of the isovalue on which NaN is";
    case Remedy::only_coarse:
      return error.problem() + "; use --coarse, or resample the volume to a box-shaped grid";
    case Remedy::allow_memory:
      return error.problem() + "; allow more with --max-memory";
    case Remedy::none:
      break;
  }
  return error.what();
}

}  // namespace isoatlas::detail::tool
