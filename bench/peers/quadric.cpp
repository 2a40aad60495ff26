// SPDX-License-Identifier: Apache-2.0
// Decimates the mesh of vtkFlyingEdges3D to a number of triangles with vtkQuadricDecimation.
#include <vtkQuadricDecimation.h>

#include <algorithm>

#include "flying_edges.h"
#include "peer.h"

int main(int argc, char** argv) {
  using namespace isoatlas;
  using namespace isoatlas::detail;
  return bench::run_peer(
      argc, argv, [](const VolumeView& volume, double isovalue, const bench::Goal& goal) {
        const auto full =
            static_cast<double>(bench::flying_edges(volume, isovalue)->GetNumberOfPolys());
        bench::Peer peer;
        peer.name = "quadric";
        peer.parameter = "triangles";
        peer.coarsest = std::min(full, 8.0);
        peer.finest = full;
        peer.start = 1.5 * static_cast<double>(goal.triangles);
        peer.mesh = [volume, isovalue, full](double triangles) {
          vtkNew<vtkQuadricDecimation> decimation;
          decimation->SetInputData(bench::flying_edges(volume, isovalue));
          decimation->SetTargetReduction(1 - triangles / full);
          decimation->Update();
          return bench::triangle_mesh(decimation->GetOutput());
        };
        return peer;
      });
}
