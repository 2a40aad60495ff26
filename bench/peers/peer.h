// SPDX-License-Identifier: Apache-2.0
// What the programs of this folder have in common: each runs isoatlas and one peer on a volume, and
// searches the coarsest mesh of the peer that is as close to the isosurface as that of isoatlas.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "isoatlas/mesh.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail::bench {

/// What a peer has to match.
struct Goal {
  double distance_voxels = 0;  ///< measured, both ways
  std::size_t triangles = 0;   ///< of isoatlas' mesh
};

/// Another program that meshes an isosurface, with one parameter for the size of its triangles.
struct Peer {
  std::string name;
  std::string parameter;  ///< the name of the parameter, with its unit
  double coarsest = 0,
         finest = 0;  ///< the range that may be searched; either may be the larger one
  double start = 0;   ///< where the search starts
  /// The whole way from the samples to a mesh, in coordinates of index times spacing.
  std::function<TriangleMesh(double parameter)> mesh;
};

using MakePeer = std::function<Peer(const VolumeView& volume, double isovalue, const Goal& goal)>;

/// The main function of a peer's program: VOLUME ISOVALUE [--refine VOXELS] [--distance VOXELS]
/// [--repeats N]. Prints one JSON line.
int run_peer(int argc, char** argv, const MakePeer& make_peer);

}  // namespace isoatlas::detail::bench
