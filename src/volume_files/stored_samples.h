// SPDX-License-Identifier: Apache-2.0
// Selects the samples of a volume from those that a header describes: in one or more files, with
// axes that may differ from the volume's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "isoatlas/volume_file.h"
#include "volume_files/piece_reader.h"

namespace isoatlas::detail::io {

struct StoredAxis {
  std::uint64_t size = 1;
  std::optional<std::uint64_t> selected =
      {};  ///< the one index that is read; empty for an axis of the volume
};

struct StoredSamples {
  std::vector<SamplePiece> pieces = {};  ///< in order, of equal size
  SampleFormat format = {};
  bool is_big_endian = false;
  std::vector<StoredAxis> axes = {};  ///< fastest first
};

/// The number of samples of all axes. @throws Error(bad_file) if their bytes do not fit in 63 bits
std::uint64_t checked_sample_count(const std::filesystem::path& path,
                                   const std::vector<StoredAxis>& axes, SampleType type);

/// Reads the samples with the selected indices, in the machine's byte order. Sets `source.reader`,
/// and adds a warning to `source.warnings` if a file has more samples than the header states.
///
/// @param header_file  named in errors about other files
std::shared_ptr<std::byte[]> read_stored_samples(const std::filesystem::path& header_file,
                                                 const StoredSamples& stored,
                                                 const ReadOptions& options, VolumeSource& source);

}  // namespace isoatlas::detail::io
