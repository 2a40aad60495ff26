// SPDX-License-Identifier: Apache-2.0
// Headerless samples: the caller states their layout, which must agree with the file's size. The
// whole file may be compressed by gzip or bzip2.
#include <bit>
#include <cmath>
#include <string>

#include "files/byte_source.h"
#include "files/file_error.h"
#include "files/stored_data.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/readers.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse_size(const fs::path& path, const RawLayout& layout, std::uint64_t found,
                              std::uint64_t expected, bool is_packed) {
  throw bad_file(
      path,
      std::string(is_packed && found > layout.offset + 2 * expected ? "has more than " : "has ") +
          std::to_string(found) + " bytes" + (is_packed ? " when decompressed" : "") + ", but " +
          (layout.offset > 0 ? "after an offset of " + std::to_string(layout.offset) + " " : "") +
          std::to_string(layout.size[0]) + " x " + std::to_string(layout.size[1]) + " x " +
          std::to_string(layout.size[2]) + " samples of " + std::string(name(layout.type)) +
          " are " + std::to_string(expected) + " bytes");
}

// A file of exactly the expected size is not compressed, even if its first bytes look like it.
Packing packing_of_samples(const fs::path& path, const RawLayout& layout, std::uint64_t bytes) {
  const std::uint64_t file_bytes = readable_file_size(path);
  const bool is_plain = layout.offset <= file_bytes && file_bytes - layout.offset == bytes;
  const Packing packing = is_plain ? Packing::none : packing_of(path);
  if (!is_plain && packing == Packing::none) {
    refuse_size(path, layout, file_bytes, bytes, false);
  }
  if (packing == Packing::deflate) {
    require_possible_bytes(path, bytes, file_bytes);
  }
  return packing;
}

void read_packed(const fs::path& path, const RawLayout& layout, Packing packing, std::byte* samples,
                 std::uint64_t bytes) {
  ByteSource source(path, 0, packing);
  source.skip(layout.offset);
  const std::uint64_t count = source.read(samples, static_cast<std::size_t>(bytes));
  const std::uint64_t rest = source.count_rest(bytes + 1);
  if (count < bytes || rest > 0) {
    refuse_size(path, layout, layout.offset + count + rest, bytes, true);
  }
}

}  // namespace

VolumeFile read_raw(const fs::path& path, const ReadOptions& options) {
  const RawLayout& layout = *options.raw;
  for (const double spacing : layout.spacing) {
    if (!std::isfinite(spacing) || spacing <= 0) {
      throw Error(ErrorCode::bad_argument,
                  one_line(path.string() + ": raw layout with spacing " + std::to_string(spacing) +
                           ", expected positive lengths"));
    }
  }
  const std::size_t sample_bytes = bytes_per_sample(layout.type);
  const std::uint64_t bytes = checked_sample_bytes(path, layout.size, sample_bytes);
  const Packing packing = packing_of_samples(path, layout, bytes);
  const bool is_swapped =
      sample_bytes > 1 && layout.big_endian != (std::endian::native == std::endian::big);
  std::shared_ptr<std::byte[]> samples;
  if (packing == Packing::none && !is_swapped)
    samples = mapped_samples(path, layout.offset, bytes, sample_bytes, options);
  if (samples == nullptr) {
    samples = allocate_samples(path, bytes, options);
    if (packing == Packing::none) {
      ByteSource(path, layout.offset, Packing::none).read_samples(samples.get(), bytes);
    } else {
      read_packed(path, layout, packing, samples.get(), bytes);
    }
    if (is_swapped) swap_byte_order(samples.get(), bytes / sample_bytes, sample_bytes);
  }
  VolumeFile file;
  file.volume.view.grid.size = layout.size;
  file.volume.view.grid.spacing = {layout.spacing[0], layout.spacing[1], layout.spacing[2]};
  file.volume.view.grid.unit = layout.unit;
  file.volume.view.type = layout.type;
  file.volume.view.samples = samples.get();
  file.volume.owner = samples;
  file.source.format = "headerless samples";
  file.source.reader = "isoatlas";
  return file;
}

}  // namespace isoatlas::detail::io
