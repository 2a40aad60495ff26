// SPDX-License-Identifier: Apache-2.0
// Arrays have their axes in one order, coordinates are wanted in another, and the library has one
// of its own.
#pragma once

#include <array>

#include "isoatlas/extract.h"
#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail::python {

/// Which coordinate of the caller's each axis of the library is: x, the one along which samples are
/// neighbours in memory, is coordinate of[0], y is of[1], z is of[2]. Samples never move for the
/// sake of it: points do.
///
/// Where coordinates are swapped an odd number of times, what is seen is a mirror image, so
/// triangles are turned over: they face outward in either's coordinates.
class Axes {
 public:
  explicit Axes(const std::array<int, 3>& of) : of_(of) {}

  /// RAS is x and y negated; where these are not the library's x and y, it has to be asked for LPS,
  /// and what follows negates.
  Space space_in_library(Space caller) const {
    return caller == Space::ras && !is_same() ? Space::lps : caller;
  }

  Vec3 to_library(Vec3 caller) const;
  Grid to_library(const Grid& caller) const;
  void to_library(TriangleMesh& mesh, Space space) const;

  Vec3 to_caller(Vec3 library) const;
  void to_caller(Extraction& extraction,
                 Space space) const;  ///< triangles and all places in its report
  void to_caller(Measurement& measurement, Space space) const;

 private:
  bool is_same() const { return of_ == std::array{0, 1, 2}; }
  bool mirrors() const;

  std::array<int, 3> of_;
};

}  // namespace isoatlas::detail::python
