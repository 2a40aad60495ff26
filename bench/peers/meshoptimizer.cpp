// SPDX-License-Identifier: Apache-2.0
// Decimates the mesh of vtkFlyingEdges3D to a number of triangles with meshopt_simplify.
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <vector>

#include "flying_edges.h"
#include "peer.h"

namespace {

// An error bound that is never reached, relative to the extent of the mesh: the number of triangles
// ends the decimation.
constexpr float kAnyError = 1e3F;

isoatlas::TriangleMesh simplify(isoatlas::TriangleMesh mesh, double triangles) {
  std::vector<std::array<float, 3>> positions;
  positions.reserve(mesh.positions.size());
  for (const isoatlas::Vec3& p : mesh.positions)
    positions.push_back(
        {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  std::vector<unsigned int> corners;
  corners.reserve(3 * mesh.triangles.size());
  for (const isoatlas::Triangle& t : mesh.triangles)
    corners.insert(corners.end(), t.begin(), t.end());
  corners.resize(meshopt_simplify(corners.data(), corners.data(), corners.size(),
                                  positions[0].data(), positions.size(), sizeof positions[0],
                                  3 * static_cast<std::size_t>(triangles), kAnyError, 0, nullptr));
  mesh.triangles.clear();
  for (std::size_t i = 0; i < corners.size(); i += 3)
    mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  return mesh;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace isoatlas;
  using namespace isoatlas::detail;
  return bench::run_peer(
      argc, argv, [](const VolumeView& volume, double isovalue, const bench::Goal& goal) {
        const auto full =
            static_cast<double>(bench::flying_edges(volume, isovalue)->GetNumberOfPolys());
        bench::Peer peer;
        peer.name = "meshoptimizer";
        peer.parameter = "triangles";
        peer.coarsest = std::min(full, 8.0);
        peer.finest = full;
        peer.start = 1.5 * static_cast<double>(goal.triangles);
        peer.mesh = [volume, isovalue](double triangles) {
          return simplify(bench::triangle_mesh(bench::flying_edges(volume, isovalue)), triangles);
        };
        return peer;
      });
}
