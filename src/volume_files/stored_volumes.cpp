// SPDX-License-Identifier: Apache-2.0
#include "volume_files/stored_volumes.h"

#include <bit>
#include <limits>

#include "files/file_error.h"
#include "isoatlas/version.h"
#include "volume_files/grid_of_file.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

// The number of bytes after the samples that are counted at most: a warning needs no more.
constexpr std::uint64_t kMostCounted = std::uint64_t{1} << 20;

// The largest number of volumes, which are listed for a choice.
constexpr std::uint64_t kMostVolumes = 1'000'000;

// The largest compression ratio of bzip2, for a file of zeros.
constexpr std::uint64_t kMostPerBzip2Byte = 2'000'000;

std::uint64_t all_bytes(const StoredVolumes& stored) {
  constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (stored.offset > kMost / 2 || stored.count > kMost / 2 / stored.volume_bytes) {
    throw bad_file(stored.file, "the header states " + std::to_string(stored.count) +
                                    " volumes of " + std::to_string(stored.volume_bytes) +
                                    " bytes, more than any file can hold");
  }
  return stored.count * stored.volume_bytes;
}

void warn_of_more(VolumeSource& source, std::uint64_t bytes, bool is_counted_to_the_end) {
  source.warnings.push_back("has " + std::to_string(bytes) +
                            (is_counted_to_the_end ? "" : " or more") +
                            " bytes after the samples that its header states; they are ignored");
}

ByteSource stream_at(const fs::path& file, Packing packing, std::uint64_t position) {
  if (packing == Packing::none) return {file, position, packing};
  ByteSource stream(file, 0, packing);
  stream.skip(position);
  return stream;
}

void require_rest(ByteSource& stream, const StoredVolumes& stored, std::uint64_t index,
                  VolumeSource& source) {
  const std::uint64_t left = (stored.count - index - 1) * stored.volume_bytes;
  const std::uint64_t found = stream.count_rest(left + kMostCounted);
  if (found < left)
    require_stored_bytes(stored.file, all_bytes(stored), (index + 1) * stored.volume_bytes + found);
  if (found > left && !stored.has_footer)
    warn_of_more(source, found - left, found < left + kMostCounted);
}

}  // namespace

void require_stored_volumes(const StoredVolumes& stored, VolumeSource& source) {
  if (stored.count > kMostVolumes) {
    throw unsupported(stored.file, "has " + std::to_string(stored.count) +
                                       " volumes, expected at most " +
                                       std::to_string(kMostVolumes));
  }
  const std::uint64_t stated = all_bytes(stored);
  const std::uint64_t file_bytes = readable_file_size(stored.file);
  const Packing packing = packing_of(stored.file);
  if (packing == Packing::deflate) return require_possible_bytes(stored.file, stated, file_bytes);
  if (packing == Packing::bzip2)
    return require_possible_bytes(stored.file, stated, file_bytes, kMostPerBzip2Byte);
  const std::uint64_t available = file_bytes - std::min(stored.offset, file_bytes);
  require_stored_bytes(stored.file, stated, available);
  if (available > stated && !stored.has_footer) warn_of_more(source, available - stated, true);
}

void read_stored_volume(const StoredVolumes& stored, std::uint64_t index, VolumeFile& file,
                        const ReadOptions& options,
                        const std::function<void(ByteSource&, std::byte*)>& read) {
  Volume& volume = file.volume;
  const std::uint64_t bytes =
      checked_sample_bytes(stored.file, volume.view.grid.size, bytes_per_sample(volume.view.type));
  const std::shared_ptr<std::byte[]> samples = allocate_samples(stored.file, bytes, options);
  const Packing packing = packing_of(stored.file);
  ByteSource stream = stream_at(stored.file, packing, stored.offset + index * stored.volume_bytes);
  read(stream, samples.get());
  if (packing != Packing::none) require_rest(stream, stored, index, file.source);
  volume.view.samples = samples.get();
  volume.owner = samples;
  file.source.reader = "isoatlas " ISOATLAS_VERSION;
}

void read_plain_samples(const StoredVolumes& stored, std::uint64_t index, bool swap,
                        VolumeFile& file, const ReadOptions& options) {
  const std::size_t sample_bytes = bytes_per_sample(file.volume.view.type);
  if (!(swap && sample_bytes > 1) && packing_of(stored.file) == Packing::none) {
    if (const std::shared_ptr<std::byte[]> samples =
            mapped_samples(stored.file, stored.offset + index * stored.volume_bytes,
                           stored.volume_bytes, sample_bytes, options)) {
      file.volume.view.samples = samples.get();
      file.volume.owner = samples;
      file.source.reader = "isoatlas " ISOATLAS_VERSION;
      return;
    }
  }
  read_stored_volume(stored, index, file, options, [&](ByteSource& stream, std::byte* samples) {
    stream.read_samples(samples, stored.volume_bytes);
    if (swap) swap_byte_order(samples, stored.volume_bytes / sample_bytes, sample_bytes);
  });
}

void read_half_samples(const StoredVolumes& stored, std::uint64_t index, bool swap,
                       VolumeFile& file, const ReadOptions& options) {
  const std::uint64_t count = file.volume.view.grid.sample_count();
  read_stored_volume(stored, index, file, options, [&](ByteSource& stream, std::byte* samples) {
    read_converted<std::uint16_t>(stream, stored.file, count, swap,
                                  reinterpret_cast<float*>(samples), float_of_half);
  });
}

std::string unpacked_start(const fs::path& file, std::size_t limit) {
  std::string bytes(limit, '\0');
  bytes.resize(ByteSource(file, 0, packing_of(file)).read(bytes.data(), bytes.size()));
  return bytes;
}

float float_of_half(std::uint16_t half) {
  constexpr unsigned kExponentBits = 5, kFractionBits = 10;
  constexpr std::uint32_t kLargestExponent = (1U << kExponentBits) - 1;
  const std::uint32_t sign = static_cast<std::uint32_t>(half >> 15) << 31;
  const std::uint32_t exponent = half >> kFractionBits & kLargestExponent;
  const std::uint32_t fraction = half & ((1U << kFractionBits) - 1);
  if (exponent == 0) {  // zero or subnormal: fraction * 2^-24
    return std::bit_cast<float>(
        sign | std::bit_cast<std::uint32_t>(static_cast<float>(fraction) * 0x1p-24F));
  }
  const std::uint32_t float_exponent = exponent == kLargestExponent ? 255 : exponent + 127 - 15;
  return std::bit_cast<float>(sign | float_exponent << 23 | fraction << 13);
}

}  // namespace isoatlas::detail::io
