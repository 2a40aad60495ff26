// SPDX-License-Identifier: Apache-2.0
// The samples of a volume among those that a header describes: in one or more files, with axes that
// are not the volume's.
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
      {};  ///< the one index that is read; none: an axis of the volume
};

struct StoredSamples {
  std::vector<SamplePiece> pieces = {};  ///< one after the other, of equal size
  SampleFormat format = {};
  bool is_big_endian = false;
  std::vector<StoredAxis> axes = {};  ///< fastest first
};

/// How many samples all axes make. @throws Error(bad_file) if their bytes do not fit in 63 bits
std::uint64_t checked_sample_count(const std::filesystem::path& path,
                                   const std::vector<StoredAxis>& axes, SampleType type);

/// Reads the samples with the selected indices, in the machine's byte order. Fills `source.reader`
/// and warns in `source.warnings` of a file that has more than the header states.
///
/// @param header_file  named in errors about another file
std::shared_ptr<std::byte[]> read_stored_samples(const std::filesystem::path& header_file,
                                                 const StoredSamples& stored,
                                                 const ReadOptions& options, VolumeSource& source);

}  // namespace isoatlas::detail::io
