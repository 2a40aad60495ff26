// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "isoatlas/error.h"

namespace isoatlas::detail::tool {

/// The error in one line, with the options of the command line that would help.
inline std::string error_text(const Error& error) {
  switch (error.remedy()) {
    case Remedy::place_nan:
      return error.problem() +
             ": say with --nan below or --nan above on which side of the isovalue NaN lies";
    case Remedy::only_coarse:
      return error.problem() + "; use --coarse, or resample the volume to a box-shaped grid";
    case Remedy::allow_memory:
      return error.problem() + "; --max-memory allows more";
    case Remedy::none:
      break;
  }
  return error.what();
}

}  // namespace isoatlas::detail::tool
