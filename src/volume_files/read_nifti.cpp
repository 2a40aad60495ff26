// SPDX-License-Identifier: Apache-2.0
// NIfTI-1 and Analyze 7.5 by ITK. Its NIfTI library writes to stderr what it does not like in a header and fills
// samples that are missing with zeros without a word: both are checked here first.
#include <itkNiftiImageIO.h>
#include <nifti1_io.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "files/file_error.h"
#include "volume_files/readers.h"
#include "volume_files/itk_image.h"
#include "files/library_messages.h"
#include "files/stored_data.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kHeaderBytes = 348;

template <class Value>
Value field(const std::string& header, std::size_t offset, bool swap) {
  std::array<char, sizeof(Value)> bytes;
  std::copy_n(header.begin() + static_cast<std::ptrdiff_t>(offset), bytes.size(), bytes.begin());
  if (swap) {
    std::reverse(bytes.begin(), bytes.end());
  }
  return std::bit_cast<Value>(bytes);
}

struct StoredSamples {
  fs::path file;
  std::uint64_t offset = 0;
  std::uint64_t bytes_per_sample = 0;
  int type = 0;
  bool swap = false;
};

bool has_extension(const fs::path& path, std::string_view extension) {
  std::string found = path.extension().string();
  std::ranges::transform(found, found.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return found == extension;
}

// The other half of a .hdr/.img pair, as it is there: plain or gzipped, in the case of the given half.
fs::path sibling(const fs::path& path, std::string_view lower, std::string_view upper) {
  for (const std::string_view extension : {lower, upper}) {
    for (const std::string_view packing : {"", ".gz"}) {
      fs::path candidate = path;
      candidate.replace_extension(std::string(extension) + std::string(packing));
      std::error_code ignored;
      if (fs::is_regular_file(candidate, ignored)) {
        return candidate;
      }
    }
  }
  throw bad_file(path, "there is no " + std::string(lower) + " file beside it");
}

std::uint64_t bytes_of_type(int nifti_type, const fs::path& path) {
  switch (nifti_type) {
    case NIFTI_TYPE_INT8:
    case NIFTI_TYPE_UINT8:
      return 1;
    case NIFTI_TYPE_INT16:
    case NIFTI_TYPE_UINT16:
      return 2;
    case NIFTI_TYPE_INT32:
    case NIFTI_TYPE_UINT32:
    case NIFTI_TYPE_FLOAT32:
      return 4;
    case NIFTI_TYPE_INT64:
    case NIFTI_TYPE_UINT64:
    case NIFTI_TYPE_FLOAT64:
      return 8;
    default:
      throw unsupported(path, "has samples of type " + std::to_string(nifti_type) + " (" + nifti_datatype_string(nifti_type) +
                                  "), expected integers of 8 to 64 bits, float or double");
  }
}

// Checks what the NIfTI library would complain about on stderr, and finds the samples.
StoredSamples read_stored_samples(const fs::path& path) {
  const bool is_image_half = has_extension(path, ".img");
  const bool is_header_half = has_extension(path, ".hdr");
  const fs::path header_file = is_image_half ? sibling(path, ".hdr", ".HDR") : path;
  const std::string header = first_bytes(header_file, kHeaderBytes);
  if (header.size() < kHeaderBytes) {
    throw bad_file(header_file, "is not a NIfTI file, or its header is cut off or damaged");
  }
  constexpr std::int32_t kSwappedHeaderBytes = 0x5C010000;
  const auto stated_bytes = field<std::int32_t>(header, 0, false);
  const bool swap = stated_bytes == kSwappedHeaderBytes;
  if (stated_bytes == 540 || stated_bytes == 0x1C020000) {
    throw unsupported(header_file, "is a NIfTI-2 file, expected NIfTI-1");
  }
  if (!swap && stated_bytes != static_cast<std::int32_t>(kHeaderBytes)) {
    throw bad_file(header_file, "is not a NIfTI file");
  }
  const auto dimensions = field<std::int16_t>(header, 40, swap);
  if (dimensions < 1 || dimensions > 7) {
    throw bad_file(header_file, "has " + std::to_string(dimensions) + " dimensions, expected 3");
  }
  for (int axis = 1; axis <= dimensions; ++axis) {
    const auto samples = field<std::int16_t>(header, 40 + 2 * static_cast<std::size_t>(axis), swap);
    if (samples < 1) {
      throw bad_file(header_file, "has " + std::to_string(samples) + " samples along axis " + std::to_string(axis));
    }
  }
  for (int axis = 1; axis <= std::min<int>(dimensions, 3); ++axis) {
    // The library takes 1 for 0 and goes on.
    const auto spacing = field<float>(header, 76 + 4 * static_cast<std::size_t>(axis), swap);
    if (!std::isfinite(spacing) || spacing == 0) {
      throw bad_file(header_file,
                     "the spacing along axis " + std::to_string(axis) + " is " + std::to_string(spacing) + ", expected a positive length");
    }
  }
  StoredSamples stored;
  stored.type = field<std::int16_t>(header, 70, swap);
  stored.bytes_per_sample = bytes_of_type(stored.type, header_file);
  stored.swap = swap;
  stored.file = is_header_half ? sibling(path, ".img", ".IMG") : path;
  const auto offset = field<float>(header, 108, swap);
  const double least_offset = is_image_half || is_header_half ? 0 : 352;
  stored.offset = static_cast<std::uint64_t>(std::clamp<double>(std::isfinite(offset) ? offset : 0, least_offset, 1e15));
  return stored;
}

// By its content: the NIfTI library reads a plain file under the name .nii.gz as what it is.
bool is_gzipped(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return file.get() == 0x1F && file.get() == 0x8B;
}

// The NIfTI library reads NaN and infinity as 0. Looks at the stored floats once more and puts them back; a header's scale leaves
// NaN what it is and infinity infinite.
template <class Stored, class Sample>
void restore_non_finite(const StoredSamples& stored, std::uint64_t count, Sample* samples) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(stored.file.c_str(), "rb"), gzclose);  // plain files as well
  std::vector<Stored> buffer(1 << 16);
  if (!file || gzseek(file.get(), static_cast<z_off_t>(stored.offset), SEEK_SET) < 0) throw bad_file(stored.file, "cannot be read again");
  for (std::uint64_t done = 0; done < count;) {
    const std::uint64_t n = std::min<std::uint64_t>(buffer.size(), count - done);
    const auto bytes = static_cast<unsigned>(n * sizeof(Stored));
    if (gzread(file.get(), buffer.data(), bytes) != static_cast<int>(bytes)) throw bad_file(stored.file, "is cut off");
    for (std::uint64_t i = 0; i < n; ++i) {
      Stored value = buffer[i];
      if (stored.swap) {
        auto bits = std::bit_cast<std::array<char, sizeof(Stored)>>(value);
        std::reverse(bits.begin(), bits.end());
        value = std::bit_cast<Stored>(bits);
      }
      if (!std::isfinite(value)) samples[done + i] = static_cast<Sample>(value);
    }
    done += n;
  }
}

void restore_non_finite(const StoredSamples& stored, Volume& volume) {
  // The samples are ours until the volume is handed out.
  void* const samples = const_cast<void*>(volume.samples);
  const std::uint64_t count = volume.grid.sample_count();
  const auto into = [&](auto* typed) {
    if (stored.type == NIFTI_TYPE_FLOAT32) restore_non_finite<float>(stored, count, typed);
    if (stored.type == NIFTI_TYPE_FLOAT64) restore_non_finite<double>(stored, count, typed);
  };
  if (volume.type == SampleType::float32) into(static_cast<float*>(samples));
  if (volume.type == SampleType::float64) into(static_cast<double*>(samples));
}

}  // namespace

VolumeFile read_nifti(const fs::path& path, const ReadOptions& options) {
  const LibraryMessages messages;
  nifti_set_debug_level(0);  // it writes to stderr
  const StoredSamples stored = read_stored_samples(path);
  Volume volume = read_itk_volume(*itk::NiftiImageIO::New(), path, "NIfTI file", [&](const ImageHeader& header) {
    // What is on disk: a scale in the header makes floats of it later.
    const std::uint64_t promised = header.sample_count() * stored.bytes_per_sample;
    check_data_file(path, stored.file, [&] {
      const std::uint64_t file_bytes = readable_file_size(stored.file);
      if (is_gzipped(stored.file)) {
        require_possible_bytes(stored.file, promised, file_bytes);
        require_inflated_bytes(stored.file, 0, stored.offset + promised);
      } else {
        require_stored_bytes(stored.file, promised, file_bytes - std::min(stored.offset, file_bytes));
      }
    });
  }, options);
  restore_non_finite(stored, volume);
  VolumeFile file{std::move(volume), {}};
  file.source.format = "NIfTI-1";
  return file;
}

}  // namespace isoatlas::io
