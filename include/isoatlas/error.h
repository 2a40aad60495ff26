// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "isoatlas/export.h"

namespace isoatlas {

/// The kind of an error.
enum class ErrorCode {
  bad_argument,   ///< an option or argument has a value outside its domain
  bad_file,       ///< a file is missing, truncated, malformed or not writable
  unsupported,    ///< the input is valid, but isoatlas cannot process it
  empty_surface,  ///< no surface is left to mesh at this isovalue
  internal,       ///< a check of the result failed: a bug, no mesh is returned
  out_of_memory,  ///< an allocation failed
  cancelled,      ///< the caller cancelled the computation
};

/// What the caller can do about an error. The library's texts name members of its own structs; a
/// program with its own options can show the names of those instead.
enum class Remedy : std::uint8_t {
  none,          ///< problem() already contains the advice, or no advice exists
  place_nan,     ///< "set SurfaceOptions::non_finite to below or above"
  only_coarse,   ///< "leave ExtractOptions::refine and ::coarse empty, or resample the volume to a
                 ///< box-shaped grid"
  allow_memory,  ///< "set ReadOptions::max_memory to allow more"
};

/// The exception type of the library. what() is one line of text: what is wrong, where, what was
/// expected, and what to do.
class ISOATLAS_API Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& problem, Remedy remedy = Remedy::none)
      : std::runtime_error(problem + text_of(remedy)),
        code_(code),
        remedy_(remedy),
        problem_size_(problem.size()) {}

  ErrorCode code() const noexcept { return code_; }
  Remedy remedy() const noexcept { return remedy_; }
  /// what() without the text of the remedy.
  std::string problem() const { return std::string(what()).substr(0, problem_size_); }

  /// A copy with `prefix` in front of its message, for example the path of a file.
  Error with_prefix(const std::string& prefix) const {
    return {code_, prefix + problem(), remedy_};
  }

 private:
  static std::string text_of(Remedy remedy) {
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
