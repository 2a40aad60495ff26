// SPDX-License-Identifier: Apache-2.0
// The meshes of blocks in a folder: a run that was ended continues where it was, and several runs
// can share the work.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "isoatlas/blocks.h"
#include "isoatlas/volume_reader.h"

namespace isoatlas::detail::tool {

/// The message of an interrupted run that makes such files.
inline constexpr const char* kBlocksAreKept = "interrupted; the meshes of finished blocks are kept";

/// A range of blocks, `last` excluded.
struct BlockRange {
  std::size_t first = 0, last = static_cast<std::size_t>(-1);
};

class BlockParts {
 public:
  /// @param folder  is created if it does not exist
  /// @throws Error(bad_file) if that is not possible
  BlockParts(std::filesystem::path folder, const BlockPlan& plan);

  std::filesystem::path path_of(std::size_t block) const;

  /// Makes the files of blocks that are missing, or were made from other samples, options or by
  /// another version. A block that another run is making is left to it.
  /// @return the blocks that other runs are making
  std::vector<std::size_t> make(const VolumeReader& volume, const ExtractOptions& options,
                                const BlockRange& range, const RunControl& control) const;

  /// The numbers of the blocks without a file.
  std::vector<std::size_t> missing() const;

  /// Merges all blocks. @throws Error as read_block() and merge_blocks()
  Extraction merge(const SamplesOfBlock& samples_of, const ExtractOptions& options,
                   const RunControl& control) const;

 private:
  std::filesystem::path folder_;
  const BlockPlan& plan_;
};

}  // namespace isoatlas::detail::tool
