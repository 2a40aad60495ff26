// SPDX-License-Identifier: Apache-2.0
// NIfTI-1, NIfTI-2 and Analyze 7.5, in one file or as a pair of .hdr and .img.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/file_name.h"
#include "field/sample_type.h"
#include "files/file_error.h"
#include "files/stored_data.h"
#include "volume_files/choice.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/nifti_header.h"
#include "volume_files/readers.h"
#include "volume_files/stored_volumes.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

/// A file name split into stem, extension and compression, the last two in lower case: "Scan",
/// ".img", ".gz".
struct NameParts {
  std::string stem, extension, packing;
};

NameParts parts_of(const fs::path& path) {
  fs::path rest = path.filename();
  NameParts parts;
  if (const std::string last = lower_case(rest.extension().string());
      last == ".gz" || last == ".bz2") {
    parts.packing = last;
    rest = rest.stem();
  }
  parts.extension = lower_case(rest.extension().string());
  parts.stem = rest.stem().string();
  return parts;
}

/// The other file of a pair: the same name with another extension, in upper or lower case,
/// compressed or not. An uncompressed file is preferred.
std::optional<fs::path> sibling(const fs::path& path, std::string_view extension) {
  const std::string stem = parts_of(path).stem;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::optional<fs::path> found;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const NameParts parts = parts_of(entry.path());
    if (parts.stem != stem || parts.extension != extension || !entry.is_regular_file(ignored))
      continue;
    if (!found ||
        std::pair(parts.packing, entry.path()) < std::pair(parts_of(*found).packing, *found))
      found = entry.path();
  }
  return found;
}

fs::path required_sibling(const fs::path& path, std::string_view extension) {
  if (const auto found = sibling(path, extension)) return *found;
  throw bad_file(path, "has no " + std::string(extension) +
                           " file next to it, expected a pair of .hdr and .img");
}

SampleType nifti_sample_type(int datatype, const fs::path& file) {
  switch (datatype) {
    case 2:
      return SampleType::uint8;
    case 4:
      return SampleType::int16;
    case 8:
      return SampleType::int32;
    case 16:
      return SampleType::float32;
    case 64:
      return SampleType::float64;
    case 256:
      return SampleType::int8;
    case 512:
      return SampleType::uint16;
    case 768:
      return SampleType::uint32;
    case 1024:
      return SampleType::int64;
    case 1280:
      return SampleType::uint64;
    default:
      break;
  }
  struct OtherType {
    int datatype;
    std::string_view name;
  };
  constexpr std::array kOtherTypes{
      OtherType{0, "unknown"},       OtherType{1, "BINARY"},        OtherType{32, "COMPLEX64"},
      OtherType{128, "RGB24"},       OtherType{255, "ALL"},         OtherType{1536, "FLOAT128"},
      OtherType{1792, "COMPLEX128"}, OtherType{2048, "COMPLEX256"}, OtherType{2304, "RGBA32"}};
  const auto* const other = std::ranges::find(kOtherTypes, datatype, &OtherType::datatype);
  throw unsupported(
      file, "has samples of type " + std::to_string(datatype) + " (" +
                std::string(other == kOtherTypes.end() ? "none that NIfTI knows" : other->name) +
                "), expected integers of 8 to 64 bits, float or double");
}

std::string format_name(const NiftiHeader& header) {
  constexpr std::array<const char*, 3> kNames{"Analyze 7.5", "NIfTI-1", "NIfTI-2"};
  return kNames[static_cast<std::size_t>(header.version)];
}

// The samples' offset. 0 means directly after the header and the four bytes that state whether an
// extension follows.
std::uint64_t samples_offset(const NiftiHeader& header, const fs::path& header_file, bool is_pair) {
  const double offset = header.vox_offset;
  constexpr double kLargest = 1e15;
  if (is_pair && offset >= 0 && offset < kLargest) return static_cast<std::uint64_t>(offset);
  const double header_bytes = header.version == NiftiVersion::nifti2 ? 540 : 348;
  if (!is_pair && offset == 0) return static_cast<std::uint64_t>(header_bytes) + 4;
  if (!is_pair && offset >= header_bytes && offset < kLargest)
    return static_cast<std::uint64_t>(offset);
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", offset);
  throw bad_file(header_file, "its samples begin at byte " + std::string(text) +
                                  " by vox_offset, expected an offset after the header");
}

std::uint64_t volume_count(const NiftiHeader& header, const fs::path& path) {
  constexpr std::int64_t kMost = 1'000'000'000;
  if (header.dim[6] > 1 || header.dim[7] > 1 || header.dim[4] > kMost || header.dim[5] > kMost) {
    std::string shape;
    for (std::size_t axis = 1; axis <= static_cast<std::size_t>(header.dim[0]); ++axis) {
      shape += (axis > 1 ? " x " : "") + std::to_string(header.dim[axis]);
    }
    throw unsupported(path, "has " + std::to_string(header.dim[0]) + " dimensions (" + shape +
                                "), expected three of space, time, and values per sample");
  }
  return static_cast<std::uint64_t>(header.dim[4] * header.dim[5]);
}

/// Selects a time point and, if a sample has several values, one of them. @return the index of the
/// volume in the file
std::uint64_t chosen_volume(const fs::path& path, const NiftiHeader& header,
                            const ReadOptions& options, VolumeSource& source) {
  const auto times = static_cast<std::size_t>(header.dim[4]),
             channels = static_cast<std::size_t>(header.dim[5]);
  const std::size_t time =
      times > 1 ? take_choice(path, source, numbered_choice("time", times), options.time) : 0;
  const std::size_t channel =
      channels > 1
          ? take_choice(path, source, numbered_choice("channel", channels), options.channel)
          : 0;
  return std::uint64_t{channel} * times + time;
}

struct Rescale {
  double slope = 1, intercept = 0;
  bool is_needed() const { return slope != 1 || intercept != 0; }
};

std::string nifti_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

// A slope of 0 or NaN means that the samples are not scaled, for any intercept.
Rescale rescale_of(const NiftiHeader& header, VolumeSource& source) {
  const double slope = header.scl_slope;
  double intercept = header.scl_inter;
  if (slope == 0 || !std::isfinite(slope)) {
    if (intercept != 0 && std::isfinite(intercept)) {
      source.decisions.push_back({"rescale", "none: slope " + nifti_number(slope) +
                                                 ", its intercept " + nifti_number(intercept) +
                                                 " is ignored"});
    }
    return {};
  }
  if (!std::isfinite(intercept)) {
    source.warnings.push_back("its intercept scl_inter is " + nifti_number(intercept) +
                              "; 0 is used");
    intercept = 0;
  }
  const Rescale rescale{slope, intercept};
  if (rescale.is_needed()) {
    source.decisions.push_back(
        {"rescale", "slope " + nifti_number(slope) + ", intercept " + nifti_number(intercept)});
  }
  if (rescale.is_needed() && header.version == NiftiVersion::analyze) {
    source.warnings.push_back("its samples are multiplied by " + nifti_number(slope) +
                              ", the factor that SPM and AFNI keep in an Analyze header");
  }
  return rescale;
}

// Scaled samples are computed in double precision and stored as float, or as double if they were
// stored as double.
void read_scaled_samples(ByteSource& stream, const fs::path& file, bool swap, SampleType stored,
                         const Rescale& rescale, std::uint64_t count, std::byte* samples) {
  visit_sample_type(stored, [&](const auto* type) {
    using Stored = std::remove_cvref_t<decltype(*type)>;
    using Sample = std::conditional_t<std::is_same_v<Stored, double>, double, float>;
    read_converted<Stored>(stream, file, count, swap, reinterpret_cast<Sample*>(samples),
                           [&](Stored value) {
                             return static_cast<Sample>(static_cast<double>(value) * rescale.slope +
                                                        rescale.intercept);
                           });
  });
}

bool is_one_file(const fs::path& path) {
  constexpr std::size_t kMark1 = 344, kMark2 = 4;
  const std::string start = unpacked_start(path, kMark1 + 4);
  return start.size() == kMark1 + 4 &&
         (start.compare(kMark1, 3, "n+1") == 0 || start.compare(kMark2, 3, "n+2") == 0);
}

fs::path header_half(const fs::path& path) {
  const bool is_image = parts_of(path).extension == ".img" && !is_one_file(path);
  return is_image ? required_sibling(path, ".hdr") : path;
}

fs::path image_half(const fs::path& path, const fs::path& header_file, const NiftiHeader& header) {
  if (header_file != path) return path;
  if (!header.is_one_file) return required_sibling(path, ".img");
  // Some programs write pairs that state that they are one file.
  return parts_of(path).extension == ".hdr" ? sibling(path, ".img").value_or(path) : path;
}

void warn_of_bits(const NiftiHeader& header, SampleType type, VolumeSource& source) {
  if (header.bitpix != 0 && header.bitpix != 8 * static_cast<int>(bytes_per_sample(type))) {
    source.warnings.push_back("states " + std::to_string(header.bitpix) +
                              " bits per sample, but the type " + std::string(name(type)) +
                              "; the type is used");
  }
}

}  // namespace

VolumeFile read_nifti(const fs::path& path, const ReadOptions& options) {
  const fs::path header_file = header_half(path);
  const NiftiHeader header = read_nifti_header(header_file);
  const SampleType stored_type = nifti_sample_type(header.datatype, header_file);
  const std::array size{static_cast<std::size_t>(header.dim[1]),
                        static_cast<std::size_t>(header.dim[2]),
                        static_cast<std::size_t>(header.dim[3])};
  StoredVolumes stored;
  stored.volume_bytes = checked_sample_bytes(header_file, size, bytes_per_sample(stored_type));
  stored.count = volume_count(header, path);
  stored.file = image_half(path, header_file, header);
  stored.offset = samples_offset(header, header_file, stored.file != header_file);

  VolumeFile file;
  Volume& volume = file.volume;
  VolumeSource& source = file.source;
  source.format = format_name(header);
  check_data_file(path, stored.file, [&] { require_stored_volumes(stored, source); });
  const std::uint64_t index = chosen_volume(path, header, options, source);
  volume.view.grid = nifti_grid(header, header_file, source);
  const Rescale rescale = rescale_of(header, source);
  volume.view.type = stored_type;
  warn_of_bits(header, stored_type, source);
  check_data_file(path, stored.file, [&] {
    if (!rescale.is_needed()) return read_plain_samples(stored, index, header.swap, file, options);
    volume.view.type =
        stored_type == SampleType::float64 ? SampleType::float64 : SampleType::float32;
    read_stored_volume(stored, index, file, options, [&](ByteSource& stream, std::byte* samples) {
      read_scaled_samples(stream, stored.file, header.swap, stored_type, rescale,
                          volume.view.grid.sample_count(), samples);
    });
  });
  return file;
}

}  // namespace isoatlas::detail::io
