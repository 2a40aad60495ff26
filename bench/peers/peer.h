// SPDX-License-Identifier: Apache-2.0
// Shared code of the peer programs. Each runs isoatlas and one peer on a volume, and searches for
// the coarsest mesh of the peer that is as close to the isosurface as the mesh of isoatlas.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "isoatlas/mesh.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail::bench {

/// The target of the search.
struct Goal {
  double distance_voxels = 0;  ///< the measured two-sided distance to reach
  std::size_t triangles = 0;   ///< triangles of the mesh of isoatlas
};

/// Another program that meshes an isosurface, with one parameter for the size of its triangles.
struct Peer {
  std::string name;
  std::string parameter;  ///< the name of the parameter, with its unit
  /// The range of the search; either may be the larger number.
  double coarsest = 0, finest = 0;
  double start = 0;  ///< the first parameter of the search
  /// Makes a mesh from the samples, in coordinates of index times spacing.
  std::function<TriangleMesh(double parameter)> mesh;
};

using MakePeer = std::function<Peer(const VolumeView& volume, double isovalue, const Goal& goal)>;

/// The main function of a peer's program: VOLUME ISOVALUE [--refine VOXELS] [--distance VOXELS]
/// [--repeats N]. Prints one JSON line.
int run_peer(int argc, char** argv, const MakePeer& make_peer);

}  // namespace isoatlas::detail::bench
