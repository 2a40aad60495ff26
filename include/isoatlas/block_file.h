// SPDX-License-Identifier: Apache-2.0
// Files with the meshes of blocks. Link CMake target isoatlas::io.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "isoatlas/blocks.h"
#include "isoatlas/export.h"

namespace isoatlas {

/// A digest of all that the mesh of a block depends on: the samples, the plan, the options and the
/// version of the library. A file with the same digest need not be made again.
/// @param samples  as for mesh_block()
/// @throws Error(unsupported) if the options have a metric that is a function: its digest is
/// unknown
/// @return 64 hexadecimal digits
/// @cost   one pass over the samples of the block
ISOATLAS_API std::string block_inputs(const VolumeView& samples, const BlockPlan& plan,
                                      std::size_t block, const ExtractOptions& options);

/// The mesh of a block, and the digest of what it was made from.
struct BlockFile {
  BlockMesh mesh;
  std::string inputs;  ///< block_inputs()
};

/// Writes the mesh of a block. The file appears whole or not at all. Only the same version of
/// isoatlas can read it. The same mesh gives the same bytes, but for the times in its report.
/// @throws Error(bad_file) if the file cannot be written, for example because the disk is full
ISOATLAS_API void write_block(const BlockFile& file, const std::filesystem::path& path);

/// Reads a file of write_block() and checks its digest.
/// @throws Error(bad_file) if the file is missing, damaged, or from another version of isoatlas
ISOATLAS_API BlockFile read_block(const std::filesystem::path& path);

/// The inputs of a file of write_block(), without reading the mesh.
/// @return empty if there is no such file, or it is from another version of isoatlas
/// @throws Error(bad_file) if the file exists and is not the file of a block
ISOATLAS_API std::string inputs_of_block_file(const std::filesystem::path& path);

}  // namespace isoatlas
