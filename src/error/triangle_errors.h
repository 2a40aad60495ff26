// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "error/error_field.h"
#include "error/level_mesh.h"

namespace isoatlas::detail {

/// How a triangle is looked at: at samples about 0.8 voxels apart, or at all its points, by proof.
enum class Look { samples, proof };

/// How far a triangle is from the isosurface.
struct TriangleError {
  Farthest sample;      ///< the farthest point found and a c-vertex near it; none: no point farther than `at_most` was found
  CellId cell = kNone;  ///< of the triangle's corner nearest to that point
  double at_most = 0;   ///< no point that was looked at is farther than this
};

/// Errors of triangles, kept for as long as a triangle stays where it is. Whoever measures another surface needs another one.
class TriangleErrors {
 public:
  void make_room(std::size_t triangles) { known_.resize(triangles); }
  /// @param enough  errors up to this one need not be known, only that they are no larger
  /// @return none if the triangle with this number was another one, or elsewhere, or not looked at well enough
  const TriangleError* find(const LevelMesh& mesh, std::uint32_t triangle, double enough) const;
  void keep(const LevelMesh& mesh, std::uint32_t triangle, const TriangleError& error) {
    known_[triangle] = {fingerprint(mesh, triangle), error};
  }

 private:
  struct Known {
    std::uint64_t fingerprint = 0;
    TriangleError error;
  };
  static std::uint64_t fingerprint(const LevelMesh& mesh, std::uint32_t triangle);

  std::vector<Known> known_;  // per number of a triangle
};

/// Distances from the triangles of some cells to the isosurface: for each of these cells the largest that is found at points nearest to its
/// vertex, if it is larger than what is in `from_mesh`. Other cells' entries stay. Parallel over triangles.
///
/// Look::samples looks at the centroids of patches of a triangle. Look::proof divides the patches until the isosurface is proved to be
/// within `enough` of all their points, or a point is found that is farther (docs/theory/05-refinement.md).
///
/// @pre   surface.isosurface is not none
/// @param enough  errors up to this one need not be known, only that they are no larger
/// @param known   what was found of triangles before, by the same kind of look and on the same surface; none: all are looked at
void measure_from_mesh(const MeasuredSurface& surface, const LevelMesh& mesh, std::span<const CellId> cell_of,
                       std::span<const CellId> cells, double enough, Look look, std::vector<Farthest>& from_mesh,
                       TriangleErrors* known = nullptr);

}  // namespace isoatlas::detail
