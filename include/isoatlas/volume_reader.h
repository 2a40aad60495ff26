// SPDX-License-Identifier: Apache-2.0
// Reads a volume part by part, for volumes that do not fit into memory. Link isoatlas::io.
#pragma once

#include <filesystem>
#include <string>

#include "isoatlas/export.h"
#include "isoatlas/volume.h"
#include "isoatlas/volume_file.h"

namespace isoatlas {

/// A volume in a file, of which boxes are read when they are needed. From a Zarr folder only the
/// chunks of a box are read. The samples of an uncompressed file are mapped into memory; those of
/// other files are unpacked into a temporary file, which is mapped (ReadOptions::map_samples).
class ISOATLAS_API VolumeReader {
 public:
  /// @param options  with a region, the volume is this region; `map_samples` is not used
  /// @throws as read_volume_file()
  explicit VolumeReader(std::filesystem::path path, ReadOptions options = {});

  /// Size, lengths and type; without samples.
  const Grid& grid() const { return file_.volume.view.grid; }
  SampleType type() const { return file_.volume.view.type; }
  const VolumeSource& source() const { return file_.source; }

  /// The samples from `first` to `last`, both included. Can be called from several threads.
  /// @throws Error(bad_argument) unless these are two or more samples of the volume along each
  ///         axis; as read_volume_file()
  /// @cost   for a Zarr folder the size of the box and of the chunks that it crosses, otherwise
  /// O(1)
  Volume box(const Size3& first, const Size3& last) const;

  /// Drops the parts of mapped samples that are in memory; they are read again when they are used.
  void drop() const;

  /// sample_digest() of the volume, a few layers of samples at a time.
  std::string digest() const;

 private:
  std::filesystem::path path_;
  ReadOptions options_;
  VolumeFile file_;  // without samples if boxes are read from the file
};

}  // namespace isoatlas
