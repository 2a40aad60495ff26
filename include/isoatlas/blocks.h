// SPDX-License-Identifier: Apache-2.0
// Meshes a volume block by block: for volumes that do not fit into memory, and for several
// machines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "isoatlas/export.h"
#include "isoatlas/extract.h"
#include "isoatlas/hierarchy.h"
#include "isoatlas/options.h"
#include "isoatlas/report.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// A box of samples, for example those of a block; both ends are included.
struct BlockBox {
  Size3 first, last;
  friend bool operator==(const BlockBox&, const BlockBox&) = default;
};

/// A cut of a volume into blocks. Neighbouring blocks share one layer of samples. Blocks are
/// numbered with x fastest.
class ISOATLAS_API BlockPlan {
 public:
  /// @param grid        of the whole volume
  /// @param block_size  grid cells of a block along each axis; the last blocks may have fewer. A
  ///                    block of n grid cells has n + 1 samples along an axis
  /// @throws Error(bad_argument) if a block size is 0 or the volume has fewer than two samples
  ///         along an axis; Error(unsupported) if it has more than 2^20
  BlockPlan(const Grid& grid, const Size3& block_size);

  const Grid& grid() const { return grid_; }
  const Size3& block_size() const { return block_size_; }
  const Size3& counts() const { return counts_; }  ///< number of blocks along each axis
  std::size_t block_count() const { return counts_[0] * counts_[1] * counts_[2]; }
  /// @throws Error(bad_argument) if there is no such block
  BlockBox block(std::size_t index) const;

 private:
  Grid grid_;
  Size3 block_size_, counts_;
};

/// The mesh of a block.
struct BlockMesh {
  std::size_t block = 0;
  /// Positions are in sample-index coordinates of the whole volume, exactly: the vertices of two
  /// blocks on a shared face are equal bit by bit. No levels if the block contains no surface.
  Hierarchy hierarchy;
  ExtractReport report;  ///< positions in sample-index coordinates of the whole volume
};

/// Meshes one block. The result depends on nothing but the arguments: blocks can be meshed in any
/// order, at the same time, and on any machine.
///
/// The c-vertices on shared faces depend on the samples of these faces alone, and all of them are
/// vertices of every level. So the meshes of all blocks fit, and together they have the topology of
/// the isosurface of the whole volume (docs/theory/08-seams.md).
///
/// @param samples  those of plan.block(block). Only the size of its grid is used
/// @param options  the same for all blocks; `space` is that of the merged mesh
/// @throws as extract(), except for Error(empty_surface); Error(bad_argument) if `samples` has
///         another size than the block; Error(unsupported) for options that need the whole surface:
///         supersampling, tricubic interpolation, CoveringStrategy::halving, caps, a choice of
///         components, a number of levels, a bound on the number of vertices,
///         `measure_samples`, and permitted self-intersections
/// @cost   that of extract() for the block
ISOATLAS_API BlockMesh mesh_block(const VolumeView& samples, const BlockPlan& plan,
                                  std::size_t block, const ExtractOptions& options,
                                  const RunControl& control = {});

/// Reads a box of samples, of a block or around a shared face; for example VolumeReader::box().
using SamplesOfBlock = std::function<Volume(const BlockBox&)>;

/// Merges the meshes of all blocks into the mesh of the whole volume, and checks the result: every
/// vertex on a shared face is in all blocks that contain it, every edge there has a triangle on
/// both sides, the merged triangles of each level are a manifold with the Euler characteristic that
/// follows from the blocks' isosurfaces. Self-intersections are counted
/// (LevelReport::self_intersections); the nesting of components is not compared.
///
/// With `samples_of`, vertices on shared faces and next to them are removed where the goal of a
/// level permits it: by half-edge collapses that preserve the topology, cause no self-intersections
/// and keep the bound on the distance. Levels with bounds on other metrics than max-distance,
/// max-edge, min-edge and min-aspect keep these vertices.
///
/// Vertices are ordered by the first level that contains them, then by block; those on shared faces
/// belong to the first of their blocks. The result does not depend on the order of `meshes`.
///
/// @param meshes   of each block of the plan, once
/// @param options  those of mesh_block()
/// @param samples_of  reads boxes of at most about the size of a block; none: no vertex is removed
/// @return positions in `options.space`; ExtractReport::blocks is present
/// @throws Error(bad_argument) if a block is missing or is there twice, or if two do not fit,
///         because they were made from different samples, options or versions; Error(empty_surface)
///         if no block contains a surface; Error(unsupported) if there are 2^32 - 1 vertices or
///         more
/// @cost   O((V + T) log (V + T))
ISOATLAS_API Extraction merge_blocks(const BlockPlan& plan, std::vector<BlockMesh> meshes,
                                     const ExtractOptions& options, const RunControl& control = {},
                                     const SamplesOfBlock& samples_of = {});

/// The largest blocks, as cubes, that take about this much memory each. This is an estimate for a
/// surface that crosses a twentieth of the grid cells; merge_blocks() needs more for large meshes.
/// @param bytes  memory for one block
/// @return the size of the whole volume in grid cells if it fits
ISOATLAS_API Size3 block_size_for(const Grid& grid, SampleType type, std::uint64_t bytes);

/// Meshes all blocks of a volume, one after the other, and merges them. The samples of one block
/// are in memory at a time.
/// @param finished  called after each block with its number
/// @throws as mesh_block(), merge_blocks() and `samples_of`
ISOATLAS_API Extraction extract_in_blocks(const BlockPlan& plan, const SamplesOfBlock& samples_of,
                                          const ExtractOptions& options,
                                          const RunControl& control = {},
                                          const std::function<void(std::size_t)>& finished = {});

/// The same for a volume in memory, or mapped from a file (ReadOptions::map_samples).
ISOATLAS_API Extraction extract_in_blocks(const VolumeView& volume, const Size3& block_size,
                                          const ExtractOptions& options,
                                          const RunControl& control = {},
                                          const std::function<void(std::size_t)>& finished = {});

}  // namespace isoatlas
