// SPDX-License-Identifier: Apache-2.0
#include "complex/area_vectors.h"

#include "core/vector_math.h"

namespace isoatlas::detail {

std::vector<Vec3> area_vectors(const SurfaceComplex& complex,
                               std::span<const std::uint32_t> group_of, std::uint32_t groups) {
  std::vector<Vec3> out(groups);
  for (const Face& face : complex.faces) {
    const auto at = [&](int k) { return complex.positions[face.corner[k]]; };
    // Twice the area vector: of a quad the cross product of its diagonals, of a triangle that of
    // two sides.
    const Vec3 first = to_metric(at(2) - at(0), complex.spacing);
    const Vec3 second = to_metric(at(face.size() - 1) - at(1), complex.spacing);
    const Vec3 area = cross(first, second);
    for (int k = 0; k < face.size(); ++k) {
      Vec3& sum = out[group_of[face.corner[k]]];
      sum = sum + area;
    }
  }
  return out;
}

}  // namespace isoatlas::detail
