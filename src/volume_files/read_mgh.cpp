// SPDX-License-Identifier: Apache-2.0
// FreeSurfer's MGH, uncompressed or gzipped (MGZ). Always big-endian. Data after the samples (scan
// parameters) is not read.
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <string_view>

#include "core/vector_math.h"
#include "files/file_error.h"
#include "volume_files/choice.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/header_fields.h"
#include "volume_files/readers.h"
#include "volume_files/stored_volumes.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMghHeaderBytes = 284;  // the samples follow
constexpr std::size_t kFieldBytes = 90;       // the part of the header that is used
constexpr bool kSwap = std::endian::native == std::endian::little;

SampleType mgh_sample_type(int type, const fs::path& path) {
  switch (type) {
    case 0:
      return SampleType::uint8;
    case 1:
      return SampleType::int32;
    case 3:
      return SampleType::float32;
    case 4:
      return SampleType::int16;
    case 10:
      return SampleType::uint16;
    default:
      break;
  }
  constexpr std::array<std::string_view, 10> kOtherTypes{
      "", "", "long", "", "", "bitmap", "tensor", "complex float", "complex double", "RGB"};
  const bool is_known = type >= 0 && static_cast<std::size_t>(type) < kOtherTypes.size();
  throw unsupported(path, "has samples of type " + std::to_string(type) + " (" +
                              std::string(is_known ? kOtherTypes[static_cast<std::size_t>(type)]
                                                   : "none that MGH knows") +
                              "), expected unsigned char, int, float, short or unsigned short");
}

/// Orientation and position: the directions of the axes, and the world position of the central
/// sample, in right-anterior-superior. The central sample has half the number of samples as its
/// index, not half the extent.
struct Orientation {
  Vec3 spacing{1, 1, 1};
  std::array<Vec3, 3> axes{Vec3{-1, 0, 0}, Vec3{0, 0, -1},
                           Vec3{0, 1, 0}};  // coronal, FreeSurfer's default
  Vec3 middle{};
};

Orientation orientation_of(const HeaderFields& header, VolumeSource& source) {
  Orientation orientation;
  if (header.at<std::int16_t>(28) <= 0) {  // goodRASFlag
    source.decisions.push_back({"affine", "none"});
    source.warnings.push_back(
        "states no orientation (goodRASFlag is 0): coronal slices of 1 mm are assumed, as in "
        "FreeSurfer");
    return orientation;
  }
  const auto vector = [&](std::size_t offset) {
    return Vec3{header.float32(offset), header.float32(offset + 4), header.float32(offset + 8)};
  };
  orientation.spacing = vector(30);
  for (std::size_t axis = 0; axis < 3; ++axis) orientation.axes[axis] = vector(42 + 12 * axis);
  orientation.middle = vector(78);
  source.decisions.push_back({"affine", "direction cosines and centre"});
  return orientation;
}

Grid mgh_grid(const fs::path& path, const HeaderFields& header,
              const std::array<std::size_t, 3>& size, VolumeSource& source) {
  const Orientation orientation = orientation_of(header, source);
  const std::array spacing{orientation.spacing.x, orientation.spacing.y, orientation.spacing.z};
  Vec3 origin = orientation.middle;
  std::array<Vec3, 3> axes{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3& ras = orientation.axes[axis];
    origin = origin - (spacing[axis] * static_cast<double>(size[axis]) / 2) * ras;
    axes[axis] = {-ras.x, -ras.y, ras.z};
  }
  Grid grid = grid_of_file(path, size, orientation.spacing, {-origin.x, -origin.y, origin.z}, axes);
  grid.unit = LengthUnit::millimetre;
  return grid;
}

}  // namespace

VolumeFile read_mgh(const fs::path& path, const ReadOptions& options) {
  const std::string bytes = unpacked_start(path, kMghHeaderBytes);
  if (bytes.size() < kFieldBytes)
    throw bad_file(path, "is not an MGH file, or its header is cut off");
  const HeaderFields header(bytes, kSwap);
  constexpr int kVersion = 1;  // the byte above it states the meaning of the values
  if ((header.int32(0) & 0xFF) != kVersion) {
    throw bad_file(path, "is not an MGH file: its version is " + std::to_string(header.int32(0)) +
                             ", expected 1");
  }
  std::array<std::size_t, 4> size{};
  for (std::size_t axis = 0; axis < 4; ++axis) {
    const int samples = header.int32(4 + 4 * axis);
    if (samples < 1)
      throw bad_file(path, "has " + std::to_string(samples) + " samples along axis " +
                               std::to_string(axis + 1));
    size[axis] = static_cast<std::size_t>(samples);
  }
  const std::array volume_size{size[0], size[1], size[2]};

  VolumeFile file;
  Volume& volume = file.volume;
  file.source.format = "MGH";
  volume.view.type = mgh_sample_type(header.int32(20), path);
  const StoredVolumes stored{
      .file = path,
      .offset = kMghHeaderBytes,
      .volume_bytes = checked_sample_bytes(path, volume_size, bytes_per_sample(volume.view.type)),
      .count = size[3],
      .has_footer = true};
  require_stored_volumes(stored, file.source);
  const std::size_t frame =
      size[3] > 1 ? take_choice(path, file.source, numbered_choice("time", size[3]), options.time)
                  : 0;
  volume.view.grid = mgh_grid(path, header, volume_size, file.source);
  read_plain_samples(stored, frame, kSwap, file, options);
  return file;
}

}  // namespace isoatlas::detail::io
