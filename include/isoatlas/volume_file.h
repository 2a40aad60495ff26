// SPDX-License-Identifier: Apache-2.0
// Volumes from files. Needs the isoatlas-io library; the core library does not.
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

/// Layout of a headerless file. Samples run x fastest.
struct RawLayout {
  std::array<std::size_t, 3> size{};
  SampleType type = SampleType::uint8;
  std::array<double, 3> spacing{1, 1, 1};
  LengthUnit unit = LengthUnit::unknown;  ///< of the spacing
  bool big_endian = false;
  std::uint64_t offset = 0;  ///< bytes before the first sample
};

/// A region of interest: samples from `first` to `last`, both included, along x, y and z.
struct Region {
  static constexpr std::size_t kEnd =
      static_cast<std::size_t>(-1);  ///< as `last`: the last sample there is
  std::array<std::size_t, 3> first{0, 0, 0}, last{kEnd, kEnd, kEnd};
};

/// What to read of a file that holds more than one volume, and how.
struct ReadOptions {
  std::optional<RawLayout> raw = {};  ///< the file has no header
  std::string channel =
      {};  ///< which of several channels or values per sample: its name, or its number from 0
  std::optional<std::size_t> time = {};  ///< which of several time points, from 0
  std::string layer =
      {};  ///< which of several layers of a segmentation: its number from 0, or its name
  std::string array = {};  ///< which of several named arrays
  std::string series =
      {};  ///< which of several DICOM series: its number from 0 in the list, or its UID
  std::optional<Vec3> spacing =
      {};  ///< world length of one step along x, y and z, in place of the file's
  LengthUnit spacing_unit = LengthUnit::unknown;  ///< unit of `spacing`; unknown: the file's
  std::optional<Region> region = {};              ///< keep only this part of the volume
  std::uint64_t max_memory =
      0;  ///< largest size of the samples in bytes; 0: three quarters of the machine's memory
};

struct VolumeFile {
  Volume volume = {};
  VolumeSource source = {};
};

/// A file holds more than one volume, and the options do not say which to read.
class ISOATLAS_API ChoiceNeeded : public Error {
 public:
  ChoiceNeeded(const std::string& message, FileChoice choice, VolumeSource source)
      : Error(ErrorCode::unsupported, message),
        choice_(std::move(choice)),
        source_(std::move(source)) {}
  const FileChoice& choice() const noexcept { return choice_; }  ///< what has to be chosen
  const VolumeSource& source() const noexcept {
    return source_;
  }  ///< what is known of the file so far

 private:
  FileChoice choice_;
  VolumeSource source_;
};

/// Reads a 3-D scalar volume in its native sample type, with spacing, origin and direction in LPS.
/// docs/reference/formats.md lists the formats and what is read of each. The format is that of the
/// file's content; its extension decides only where the content does not. A folder is a DICOM
/// series or a stack of images. "-" is standard input.
///
/// @throws Error(bad_file)      missing, truncated, a header that promises more than there is,
/// sizes that overflow
/// @throws Error(unsupported)   vector, complex or 2-D image, one sample along an axis, unknown
/// format
/// @throws Error(bad_argument)  an option that the file has no use for, or a choice that it does
/// not have
/// @throws Error(out_of_memory) more samples than `max_memory` allows
/// @throws ChoiceNeeded         several volumes in the file and no option that says which
ISOATLAS_API VolumeFile read_volume_file(const std::filesystem::path& path,
                                         const ReadOptions& options = {});

/// The volume alone.
ISOATLAS_API Volume read_volume(const std::filesystem::path& path, const ReadOptions& options = {});

/// SHA-256 of the samples as they are meshed: x fastest, native type, little endian; 64 hexadecimal
/// digits. Two volumes of the same size, type and digest have the same samples. @cost one pass over
/// all samples
ISOATLAS_API std::string sample_digest(const VolumeView& volume);

}  // namespace isoatlas
