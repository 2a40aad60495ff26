// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
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

/// What the caller can do about an error. A program with options of its own can name these instead.
enum class Remedy : std::uint8_t {
  none,          ///< the problem itself states it
  place_nan,     ///< "set SurfaceOptions::non_finite to below or above"
  only_coarse,   ///< "leave ExtractOptions::refine and ::coarse empty, or resample the volume to a
                 ///< box-shaped grid"
  allow_memory,  ///< "set ReadOptions::max_memory to allow more"
};

/// The one exception type of the library. what() is one line: what, where, what was expected, what
/// to do.
class ISOATLAS_API Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& problem, Remedy remedy = Remedy::none)
      : std::runtime_error(problem + in_words(remedy)),
        code_(code),
        remedy_(remedy),
        problem_size_(problem.size()) {}

  ErrorCode code() const noexcept { return code_; }
  Remedy remedy() const noexcept { return remedy_; }
  std::string problem() const {
    return std::string(what()).substr(0, problem_size_);
  }  ///< what() without the remedy

  /// The same error with something before its problem, such as the path of the file it is about.
  Error with_prefix(const std::string& prefix) const {
    return {code_, prefix + problem(), remedy_};
  }

 private:
  static std::string in_words(Remedy remedy) {
    switch (remedy) {
      case Remedy::none:
        break;
      case Remedy::place_nan:
        return "; set SurfaceOptions::non_finite to below or above";
      case Remedy::only_coarse:
        return "; leave ExtractOptions::refine and ::coarse empty, or resample the volume to a "
               "box-shaped grid";
      case Remedy::allow_memory:
        return "; set ReadOptions::max_memory to allow more";
    }
    return "";
  }

  ErrorCode code_;
  Remedy remedy_;
  std::size_t problem_size_;
};

}  // namespace isoatlas
