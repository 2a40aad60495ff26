// SPDX-License-Identifier: Apache-2.0
// Size and topology of each component of a level.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "isoatlas/mesh.h"

namespace isoatlas::detail::python {

/// Facts about one connected component of a mesh; lengths are in the units of the positions.
struct ComponentFacts {
  std::size_t first_vertex = 0;  ///< the smallest index of its vertices
  std::size_t vertices = 0, triangles = 0;
  /// Absent if the mesh is not a consistently oriented manifold.
  std::optional<ComponentTopology> topology;
  double area = 0;
  /// The enclosed volume; negative if the triangles face inward, as around a cavity. NaN if the
  /// component is not closed, or if its topology is absent.
  double volume = 0;
  Vec3 low, high;  ///< the corners of its bounding box
};

/// The components, the one with the largest area first (ties: the smallest vertex first).
/// @throws Error(bad_argument) if a corner is out of range
/// @cost   O(T log T)
std::vector<ComponentFacts> components_of(const MeshView& mesh);

}  // namespace isoatlas::detail::python
