// SPDX-License-Identifier: Apache-2.0
// Reference tests for meshes: self-intersections, and the nesting of components. Slow, and shares
// nothing with the product.
#pragma once

#include <cstddef>

#include "isoatlas/mesh.h"

namespace isoatlas::detail::test {

struct EmbeddingCheck {
  std::size_t pairs =
      0;  ///< number of pairs of triangles that intersect beyond the hull of their common corners
  std::size_t without_area = 0;  ///< triangles with corners on one line; they are in no pair
};

/// Exact: fractions are used where long doubles leave a sign undecided. @pre the mesh is a manifold
EmbeddingCheck check_embedding(const TriangleMesh& mesh);

/// Number of components next to which the mesh does not wind 0 times around the outer side and once
/// around the inner one (or -1 and 0 for all, if the inside surrounds the mesh), by solid angles.
/// @pre the mesh is closed and oriented, and has no self-intersections
std::size_t misplaced_components(const TriangleMesh& mesh);

}  // namespace isoatlas::detail::test
