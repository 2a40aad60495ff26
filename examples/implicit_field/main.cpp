// SPDX-License-Identifier: Apache-2.0
// Meshes an implicit function and computes exact normals for shading from its gradient.
#include <isoatlas/isoatlas.h>

#include <cmath>
#include <iostream>

int main() {
  using namespace isoatlas;
  const ScalarField gyroid(
      [](Vec3 p) {
        return std::sin(p.x) * std::cos(p.y) + std::sin(p.y) * std::cos(p.z) +
               std::sin(p.z) * std::cos(p.x);
      },
      [](Vec3 p) {
        return Vec3{std::cos(p.x) * std::cos(p.y) - std::sin(p.z) * std::sin(p.x),
                    std::cos(p.y) * std::cos(p.z) - std::sin(p.x) * std::sin(p.y),
                    std::cos(p.z) * std::cos(p.x) - std::sin(p.y) * std::sin(p.z)};
      });
  const Volume volume = sample(gyroid, {-4, -4, -4}, {4, 4, 4}, 0.1);
  const Extraction result = extract(volume, 0, {within(0.02)});
  const TriangleMesh mesh = result.mesh();
  const std::vector<Vec3> normals = vertex_normals(mesh, gyroid);

  std::cout << "genus " << result.finest().topology.genus << ", "
            << result.finest().topology.boundary_loops << " boundary loops, "
            << (normals.size() == mesh.positions.size() ? "a normal for each vertex"
                                                        : "normals are missing")
            << '\n';
}
