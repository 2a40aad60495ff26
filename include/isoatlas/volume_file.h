// SPDX-License-Identifier: Apache-2.0
// Reads volumes from files. Link CMake target isoatlas::io; the core library has no file formats.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "isoatlas/error.h"
#include "isoatlas/export.h"
#include "isoatlas/volume.h"
#include "isoatlas/volume_source.h"

namespace isoatlas {

/// Layout of a file without a header. x runs fastest.
struct RawLayout {
  Size3 size{};  ///< samples along x, y and z
  SampleType type = SampleType::uint8;
  std::array<double, 3> spacing{1, 1, 1};
  LengthUnit unit = LengthUnit::unknown;  ///< unit of `spacing`
  bool big_endian = false;
  std::uint64_t offset = 0;  ///< bytes before the first sample
};

/// A region of interest: samples from `first` to `last`, both included, along x, y and z.
struct Region {
  /// As `last`: the last sample of the axis.
  static constexpr std::size_t kEnd = static_cast<std::size_t>(-1);
  Size3 first{0, 0, 0}, last{kEnd, kEnd, kEnd};
};

/// Options of read_volume_file(). `channel`, `time`, `layer`, `array` and `series` select a volume
/// in a file that contains several; leave them empty otherwise.
struct ReadOptions {
  std::optional<RawLayout> raw = {};     ///< layout of a file without a header
  std::string channel = {};              ///< a channel or component: its name, or its number from 0
  std::optional<std::size_t> time = {};  ///< a time point: its number from 0
  std::string layer = {};   ///< a layer of a segmentation: its number from 0, or its name
  std::string array = {};   ///< the name of an array
  std::string series = {};  ///< a DICOM series: its number from 0 in the list, or its UID
  /// World distance between samples along x, y and z; replaces that of the file.
  std::optional<Vec3> spacing = {};
  LengthUnit spacing_unit = LengthUnit::unknown;  ///< unit of `spacing`; unknown: that of the file
  std::optional<Region> region = {};              ///< keep only this part of the volume
  /// Largest allowed size of the samples in bytes; 0: three quarters of the machine's memory.
  std::uint64_t max_memory = 0;
  /// Map the samples of an uncompressed file in this machine's byte order into memory, so that they
  /// are read from the file where they are used. The file must not be changed as long as the volume
  /// exists. The samples of other files are unpacked into a temporary file in $TMPDIR, or else
  /// /tmp, which is mapped and deleted at once. `max_memory` does not apply to either.
  bool map_samples = false;
};

/// A volume, and the facts about its file.
struct VolumeFile {
  Volume volume = {};
  VolumeSource source = {};
};

/// Thrown if a file contains several volumes and the options select none of them.
class ISOATLAS_API ChoiceNeeded : public Error {
 public:
  ChoiceNeeded(const std::string& message, FileChoice choice, VolumeSource source)
      : Error(ErrorCode::unsupported, message),
        choice_(std::move(choice)),
        source_(std::move(source)) {}
  /// The list in the file from which an entry must be selected.
  const FileChoice& choice() const noexcept { return choice_; }
  /// The facts about the file that are known so far.
  const VolumeSource& source() const noexcept { return source_; }

 private:
  FileChoice choice_;
  VolumeSource source_;
};

/// Reads a 3-D scalar volume in its own sample type, with spacing, origin and direction; medical
/// formats are converted to LPS. docs/reference/formats.md lists the formats and the fields that
/// are read. The format is detected from the content of the file, and from its extension only if
/// the content is ambiguous.
///
/// @param path  a file; a folder with a DICOM series or a stack of images; or "-": standard input
/// @throws Error(bad_file)  the file is missing or truncated, is shorter than its header states, or
///   states sizes that overflow
/// @throws Error(unsupported)  the format is unknown, or the file contains a vector, complex or 2-D
///   image or has one sample along an axis
/// @throws Error(bad_argument)  an option does not apply to the file, or selects an entry that it
///   does not have
/// @throws Error(out_of_memory)  the samples are larger than `options.max_memory`
/// @throws ChoiceNeeded  the file contains several volumes and the options select none of them
/// @cost   one pass over the file; memory for the samples of one volume
ISOATLAS_API VolumeFile read_volume_file(const std::filesystem::path& path,
                                         const ReadOptions& options = {});

/// read_volume_file() without the facts about the file.
ISOATLAS_API Volume read_volume(const std::filesystem::path& path, const ReadOptions& options = {});

/// SHA-256 of the samples in their own type, little endian, x fastest. Two volumes with the same
/// size, type and digest have the same samples.
/// @return 64 hexadecimal digits
/// @cost   one pass over all samples
ISOATLAS_API std::string sample_digest(const VolumeView& volume);

/// Writes a volume as NRRD, with raw samples in native byte order and the space
/// left-posterior-superior. The file appears whole or not at all, and reading it gives the same
/// samples and, but for rounding, the same grid.
/// @throws Error(bad_file) if the file cannot be written
/// @cost   O(N)
ISOATLAS_API void write_nrrd(const VolumeView& volume, const std::filesystem::path& path);

}  // namespace isoatlas
