// SPDX-License-Identifier: Apache-2.0
#include "geometry/vertex_normals.h"

#include "core/vector_math.h"

namespace isoatlas::detail {

std::vector<Vec3> vertex_normals(const MeshView& mesh, double unit) {
  std::vector<Vec3> out(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]];
    const Vec3 area =
        cross((1 / unit) * (mesh.positions[t[1]] - a), (1 / unit) * (mesh.positions[t[2]] - a));
    for (const std::uint32_t v : t) out[v] = out[v] + area;
  }
  for (Vec3& n : out) n = normalized(n);
  return out;
}

}  // namespace isoatlas::detail
