// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "error/error_field.h"
#include "error/level_mesh.h"

namespace isoatlas::detail {

/// How the distance of a triangle is determined: from samples about 0.8 voxels apart, or for all
/// points by a proof.
enum class Evidence { samples, proof };

/// The distance of a triangle from the isosurface.
struct TriangleError {
  Farthest sample;  ///< the farthest point found and a c-vertex near it; kNone: no point farther
                    ///< than `upper_bound` was found
  CellId cell = kNone;     ///< of the triangle's corner nearest to that point
  double upper_bound = 0;  ///< no tested point is farther than this
};

struct TriangleDistance {
  double farthest = 0;     ///< the largest distance found
  double upper_bound = 0;  ///< no tested point is farther than this
};

/// The distance of one triangle from the isosurface, as measure_from_mesh() finds it.
TriangleDistance triangle_distance(const Isosurface& isosurface, const std::array<Vec3, 3>& corners,
                                   double exact_above, Evidence evidence);

/// Cache of triangle errors; an entry is valid as long as its triangle does not move. One cache per
/// surface and kind of evidence.
class TriangleErrorCache {
 public:
  void resize(std::size_t triangles) { entries_.resize(triangles); }
  /// @param exact_above  errors up to this are only needed as an upper bound
  /// @return none if the triangle with this id was another one, has moved or was not measured
  ///         exactly enough
  const TriangleError* find(const LevelMesh& mesh, std::uint32_t triangle,
                            double exact_above) const;
  void store(const LevelMesh& mesh, std::uint32_t triangle, const TriangleError& error) {
    entries_[triangle] = {fingerprint(mesh, triangle), error};
  }

 private:
  struct Entry {
    std::uint64_t fingerprint = 0;
    TriangleError error;
  };
  static std::uint64_t fingerprint(const LevelMesh& mesh, std::uint32_t triangle);

  std::vector<Entry> entries_;  // per triangle id
};

/// Measures distances from the triangles of some cells to the isosurface. Each of these cells gets
/// the largest distance found at points nearest to its vertex, if it is larger than its value in
/// `from_mesh`. Entries of other cells are unchanged. Parallel over triangles.
///
/// Evidence::samples tests the centroids of patches of a triangle. Evidence::proof subdivides the
/// patches until the isosurface is proved to be within `exact_above` of all their points, or a
/// point is found that is farther (docs/theory/05-refinement.md).
///
/// @pre   surface.isosurface is not none
/// @param exact_above  errors up to this are only needed as an upper bound
/// @param cache  results for triangles measured before, by the same kind of evidence on the same
///               surface; none: all are measured
void measure_from_mesh(const MeasuredSurface& surface, const LevelMesh& mesh,
                       std::span<const CellId> cell_of, std::span<const CellId> cells,
                       double exact_above, Evidence evidence, std::vector<Farthest>& from_mesh,
                       TriangleErrorCache* cache = nullptr);

}  // namespace isoatlas::detail
