// SPDX-License-Identifier: Apache-2.0
// MRC2014, CCP4 maps and IMOD's variant: electron microscopy and crystallography.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
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

constexpr std::size_t kMrcHeaderBytes = 1024;

// Offsets in the header, with the names of the specification.
constexpr std::size_t kNx = 0, kMode = 12, kNxStart = 16, kMx = 28, kCellA = 40, kCellB = 52,
                      kMapC = 64, kDmin = 76, kDmax = 80, kSpaceGroup = 88, kExtendedBytes = 92,
                      kImodStamp = 152, kImodFlags = 156, kOrigin = 196;

constexpr int kImodMark = 1146047817;
constexpr int kImodSignedBytes = 1, kImodStandardOrigin = 4, kImodHalfBytes = 16;  // flags

std::array<int, 3> triple(const HeaderFields& header, std::size_t offset) {
  return {header.int32(offset), header.int32(offset + 4), header.int32(offset + 8)};
}

std::array<double, 3> real_triple(const HeaderFields& header, std::size_t offset) {
  return {header.float32(offset), header.float32(offset + 4), header.float32(offset + 8)};
}

/// The world axis (0 to 2) of columns, rows and sections; -1 for values that are not an axis. Old
/// programs leave the fields empty.
std::array<int, 3> axes_of(const HeaderFields& header) {
  std::array<int, 3> axes = triple(header, kMapC);
  if (axes == std::array{0, 0, 0}) axes = {1, 2, 3};
  for (int& axis : axes) axis = axis >= 1 && axis <= 3 ? axis - 1 : -1;
  return axes;
}

// True if the header is valid in this byte order. The machine stamp is wrong in many files, so the
// byte order is found by this test.
bool is_plausible(const HeaderFields& header) {
  std::array<int, 3> axes = axes_of(header);
  std::ranges::sort(axes);
  const auto size = triple(header, kNx);
  constexpr int kMostModes = 128;
  return axes == std::array{0, 1, 2} && std::ranges::all_of(size, [](int n) { return n > 0; }) &&
         header.int32(kMode) >= 0 && header.int32(kMode) < kMostModes;
}

// Selects the byte order in which the header is valid. If both are, the one with the smaller sizes:
// swapped sizes are enormous.
bool is_swapped(const std::string& bytes) {
  const HeaderFields native(bytes, false), swapped(bytes, true);
  if (!is_plausible(native) || !is_plausible(swapped)) return !is_plausible(native);
  const auto largest = [](const HeaderFields& header) {
    return std::ranges::max(triple(header, kNx));
  };
  return largest(swapped) < largest(native);
}

bool is_from_imod(const HeaderFields& header) { return header.int32(kImodStamp) == kImodMark; }

/// How samples are stored.
struct MrcType {
  SampleType type = SampleType::float32;
  std::size_t bytes = 4;
  bool is_half = false;
};

// The type of 8-bit samples, which are signed since MRC2014. IMOD has a flag for it; in other files
// the stated range shows unsigned bytes.
MrcType byte_type(const HeaderFields& header, const fs::path& path, VolumeSource& source) {
  constexpr double kLargestSigned = 127, kLargestUnsigned = 255;
  const double least = header.float32(kDmin), largest = header.float32(kDmax);
  bool is_unsigned = false;
  std::string reason = "MRC2014";
  if (is_from_imod(header)) {
    if ((header.int32(kImodFlags) & kImodHalfBytes) != 0) {
      throw unsupported(path,
                        "has two samples of 4 bits in each byte (IMOD's flag), expected samples of "
                        "8 bits or more");
    }
    is_unsigned = (header.int32(kImodFlags) & kImodSignedBytes) == 0;
    reason = "IMOD's flag";
  } else if (least >= 0 && largest > kLargestSigned && largest <= kLargestUnsigned) {
    is_unsigned = true;
    reason = "the stated maximum is " + std::to_string(static_cast<int>(largest));
  }
  source.decisions.push_back({"bytes", (is_unsigned ? "unsigned, " : "signed, ") + reason});
  return {is_unsigned ? SampleType::uint8 : SampleType::int8, 1};
}

MrcType mrc_type(const HeaderFields& header, const fs::path& path, VolumeSource& source) {
  switch (const int mode = header.int32(kMode)) {
    case 0:
      return byte_type(header, path, source);
    case 1:
      return {SampleType::int16, 2};
    case 2:
      return {SampleType::float32, 4};
    case 6:
      return {SampleType::uint16, 2};
    case 12:
      return {SampleType::float32, 2, true};
    default: {
      const std::string kind = mode == 3 || mode == 4 ? "complex numbers"
                               : mode == 16           ? "colours"
                               : mode == 101          ? "4-bit integers"
                                                      : "no type that MRC2014 knows";
      throw unsupported(path, "has samples of mode " + std::to_string(mode) + " (" + kind +
                                  "), expected 0, 1, 2, 6 or 12");
    }
  }
}

/// Unit vectors along the edges a, b and c of a unit cell: a along x, b in the plane of x and y.
std::array<Vec3, 3> cell_axes(const HeaderFields& header, VolumeSource& source) {
  const std::array degrees = real_triple(header, kCellB);
  const bool is_stated =
      std::ranges::all_of(degrees, [](double angle) { return angle > 0 && angle < 180; });
  const bool is_right = std::ranges::all_of(degrees, [](double angle) { return angle == 90; });
  const std::array<Vec3, 3> kRight{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  if (!is_stated || is_right) return kRight;
  const auto cosine = [&](std::size_t i) { return std::cos(degrees[i] * std::numbers::pi / 180); };
  const double alpha = cosine(0), beta = cosine(1), gamma = cosine(2),
               sine = std::sqrt(1 - gamma * gamma);
  const double y = (alpha - beta * gamma) / sine;
  source.decisions.push_back({"axes", "by the angles of the unit cell"});
  return {Vec3{1, 0, 0}, Vec3{gamma, sine, 0}, Vec3{beta, y, std::sqrt(1 - beta * beta - y * y)}};
}

/// The step along the world's x, y and z axis, in angstrom.
std::array<double, 3> steps_of(const HeaderFields& header, VolumeSource& source) {
  const std::array intervals = triple(header, kMx);
  const std::array lengths = real_triple(header, kCellA);
  std::array<double, 3> steps{1, 1, 1};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    source.has_spacing = source.has_spacing && intervals[axis] > 0 && lengths[axis] > 0;
  }
  for (std::size_t axis = 0; axis < 3 && source.has_spacing; ++axis)
    steps[axis] = lengths[axis] / intervals[axis];
  return steps;
}

/// The position of the first sample: ORIGIN if it is not zero, otherwise NXSTART, NYSTART and
/// NZSTART steps along the axes.
Vec3 origin_of(const HeaderFields& header, const std::array<std::size_t, 3>& world_axis,
               const std::array<Vec3, 3>& axes, const std::array<double, 3>& steps,
               VolumeSource& source) {
  const std::array stated = real_triple(header, kOrigin);
  if (std::ranges::any_of(stated, [](double x) { return x != 0; })) {
    const bool is_reversed =
        is_from_imod(header) && (header.int32(kImodFlags) & kImodStandardOrigin) == 0;
    source.decisions.push_back({"origin", is_reversed ? "ORIGIN, reversed as in IMOD" : "ORIGIN"});
    return (is_reversed ? -1.0 : 1.0) * Vec3{stated[0], stated[1], stated[2]};
  }
  const std::array starts = triple(header, kNxStart);
  if (starts == std::array{0, 0, 0}) return {};
  source.decisions.push_back({"origin", "NXSTART, NYSTART and NZSTART"});
  source.origin_in_samples = {static_cast<double>(starts[0]), static_cast<double>(starts[1]),
                              static_cast<double>(starts[2])};
  Vec3 origin;
  for (std::size_t i = 0; i < 3; ++i)
    origin = origin + (starts[i] * steps[world_axis[i]]) * axes[i];
  return origin;
}

// The samples stay in the order of the file; the grid's axes hold the directions of columns, rows
// and sections.
Grid mrc_grid(const fs::path& path, const HeaderFields& header,
              const std::array<std::size_t, 3>& size, VolumeSource& source) {
  const std::array world = cell_axes(header, source);
  const std::array steps = steps_of(header, source);
  std::array<std::size_t, 3> world_axis{};
  std::ranges::transform(axes_of(header), world_axis.begin(),
                         [](int axis) { return static_cast<std::size_t>(axis); });
  const std::array axes{world[world_axis[0]], world[world_axis[1]], world[world_axis[2]]};
  const Vec3 spacing{steps[world_axis[0]], steps[world_axis[1]], steps[world_axis[2]]};
  if (world_axis != std::array<std::size_t, 3>{0, 1, 2}) {
    std::string order;
    for (const std::size_t axis : world_axis) order += "xyz"[axis];
    source.decisions.push_back({"axes", "columns, rows and sections along " + order});
  }
  Grid grid =
      grid_of_file(path, size, spacing, origin_of(header, world_axis, axes, steps, source), axes);
  if (source.has_spacing) grid.unit = LengthUnit::angstrom;
  return grid;
}

/// The number of volumes stored in sequence. Space groups from 401 on mark a stack of volumes of MZ
/// sections each.
std::size_t volume_count(const HeaderFields& header, const fs::path& path, VolumeSource& source) {
  constexpr int kFirstStackGroup = 401, kLastStackGroup = 630;
  const int group = header.int32(kSpaceGroup), sections = header.int32(kNx + 8),
            volume_sections = header.int32(kMx + 8);
  if (group == 0 && volume_sections == 1 && sections > 1) {
    source.warnings.push_back(
        "states that it is a stack of images, not a volume (space group 0, MZ 1); its images are "
        "read as slices");
  }
  if (group < kFirstStackGroup || group > kLastStackGroup) return 1;
  if (volume_sections < 1 || sections % volume_sections != 0) {
    throw bad_file(path, "is a stack of volumes of " + std::to_string(volume_sections) +
                             " sections each, but has " + std::to_string(sections) + " sections");
  }
  return static_cast<std::size_t>(sections / volume_sections);
}

}  // namespace

VolumeFile read_mrc(const fs::path& path, const ReadOptions& options) {
  const std::string bytes = unpacked_start(path, kMrcHeaderBytes);
  if (bytes.size() < kMrcHeaderBytes)
    throw bad_file(path, "is not an MRC file, or its header is cut off");
  const bool swap = is_swapped(bytes);
  const HeaderFields header(bytes, swap);
  if (!is_plausible(header)) {
    throw bad_file(path,
                   "is not an MRC file, or its header is damaged: sizes, mode and axes are not "
                   "valid in either byte order");
  }
  const int extended_bytes = header.int32(kExtendedBytes);
  if (extended_bytes < 0)
    throw bad_file(path, "its extended header has " + std::to_string(extended_bytes) + " bytes");

  VolumeFile file;
  Volume& volume = file.volume;
  file.source.format = "MRC";
  const std::size_t count = volume_count(header, path, file.source);
  const auto counts = triple(header, kNx);
  const std::array size{static_cast<std::size_t>(counts[0]), static_cast<std::size_t>(counts[1]),
                        static_cast<std::size_t>(counts[2]) / count};
  const MrcType type = mrc_type(header, path, file.source);
  volume.view.type = type.type;
  const StoredVolumes stored{.file = path,
                             .offset = kMrcHeaderBytes + static_cast<std::size_t>(extended_bytes),
                             .volume_bytes = checked_sample_bytes(path, size, type.bytes),
                             .count = count};
  require_stored_volumes(stored, file.source);
  const std::size_t index =
      count > 1 ? take_choice(path, file.source, numbered_choice("time", count), options.time) : 0;
  volume.view.grid = mrc_grid(path, header, size, file.source);
  if (type.is_half) {
    read_half_samples(stored, index, swap, file, options);
  } else {
    read_plain_samples(stored, index, swap, file, options);
  }
  return file;
}

}  // namespace isoatlas::detail::io
