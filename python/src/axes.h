// SPDX-License-Identifier: Apache-2.0
// Conversion of coordinates between the caller's order of axes and the library's order.
#pragma once

#include <array>

#include "isoatlas/extract.h"
#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail::python {

/// The caller's coordinate for each axis of the library. The library's x axis is the one with the
/// smallest stride in memory; it is the caller's coordinate of[0]. Likewise y is of[1] and z is
/// of[2]. Samples are never reordered; points are converted.
///
/// An odd permutation mirrors space. Triangles are then reversed, so that they face outward in both
/// systems of coordinates.
class Axes {
 public:
  explicit Axes(const std::array<int, 3>& of) : of_(of) {}

  /// The output space to request from the library. RAS negates the caller's x and y. If these are
  /// not the library's x and y, this is LPS, and to_caller() negates.
  Space space_in_library(Space caller) const {
    return caller == Space::ras && !is_same() ? Space::lps : caller;
  }

  Vec3 to_library(Vec3 caller) const;
  Grid to_library(const Grid& caller) const;
  void to_library(TriangleMesh& mesh, Space space) const;

  Vec3 to_caller(Vec3 library) const;
  /// Converts vertices, triangles and all positions in the report.
  void to_caller(Extraction& extraction, Space space) const;
  void to_caller(Measurement& measurement, Space space) const;

 private:
  bool is_same() const { return of_ == std::array{0, 1, 2}; }
  bool is_mirrored() const;  ///< the permutation is odd

  std::array<int, 3> of_;
};

}  // namespace isoatlas::detail::python
