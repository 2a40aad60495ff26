// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "field/to_space.h"
#include "isoatlas/mesh.h"

namespace isoatlas {
using namespace detail;

void transform_to(TriangleMesh& mesh, const Grid& grid, Space space) {
  if (space == Space::voxel) return;
  for (Vec3& p : mesh.positions) p = to_space(grid, space, p);
  if (grid.mirrored()) {
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  }
}

}  // namespace isoatlas
