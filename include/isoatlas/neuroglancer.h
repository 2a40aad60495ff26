// SPDX-License-Identifier: Apache-2.0
// Levels of detail for Neuroglancer. Link CMake target isoatlas::io.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "isoatlas/export.h"
#include "isoatlas/hierarchy.h"
#include "isoatlas/mesh_file.h"
#include "isoatlas/run_control.h"

namespace isoatlas {

/// Facts about a mesh as it is stored for Neuroglancer, per level from coarse to fine.
struct NeuroglancerMesh {
  std::vector<double> rounding;  ///< largest distance of a vertex from its stored position
  std::vector<std::size_t> self_intersections;  ///< pairs of stored triangles that intersect
  std::size_t fragments = 0;                    ///< of all levels
  std::size_t bytes = 0;                        ///< of the fragments and their index
};

/// Checks that write_neuroglancer() may write into a folder.
/// @throws Error(bad_file) if it is a file, or has a file `info` of something else
ISOATLAS_API void check_neuroglancer_folder(const std::filesystem::path& folder);

/// Writes all levels in Neuroglancer's "precomputed" multi-resolution format
/// (neuroglancer_multilod_draco), as segment 1. The source in Neuroglancer is
/// `precomputed://URL-OF-THE-FOLDER`.
///
/// Triangles are cut at the planes between fragments, and positions are rounded to 16 bits per
/// fragment, in such a way that fragments fit without gaps. What was compressed is decompressed
/// again: each level must have the topology that it had, component by component; fragments become
/// smaller until that is so. Self-intersections that rounding causes are counted.
///
/// Coordinates become nanometres; without a unit they stay as they are.
/// @param folder  is made if it does not exist
/// @param info    the unit of the mesh; the comment becomes the label of the segment
/// @throws Error(bad_file) if the folder cannot be written, or if 16 bits would change the topology
/// @cost   O(T log T) per level
ISOATLAS_API NeuroglancerMesh write_neuroglancer(const Hierarchy& hierarchy,
                                                 const std::filesystem::path& folder,
                                                 const HierarchyFileInfo& info = {},
                                                 const RunControl& control = {});

}  // namespace isoatlas
