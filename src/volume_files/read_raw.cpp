// SPDX-License-Identifier: Apache-2.0
// Headerless samples: the caller says what they are, the file's size must agree.
#include <bit>
#include <cmath>
#include <string>

#include "files/file_error.h"
#include "volume_files/byte_source.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/readers.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

VolumeFile read_raw(const fs::path& path, const ReadOptions& options) {
  const RawLayout& layout = *options.raw;
  for (const double spacing : layout.spacing) {
    if (!std::isfinite(spacing) || spacing <= 0) {
      throw Error(ErrorCode::bad_argument,
                  one_line(path.string() + ": raw layout with spacing " + std::to_string(spacing) + ", expected positive lengths"));
    }
  }
  const std::size_t sample_bytes = bytes_per_sample(layout.type);
  const std::uint64_t bytes = checked_sample_bytes(path, layout.size, sample_bytes);
  const std::uint64_t file_bytes = readable_file_size(path);
  if (layout.offset > file_bytes || file_bytes - layout.offset != bytes) {
    throw bad_file(path, "has " + std::to_string(file_bytes) + " bytes, but " +
                             (layout.offset > 0 ? "after an offset of " + std::to_string(layout.offset) + " " : "") +
                             std::to_string(layout.size[0]) + " x " + std::to_string(layout.size[1]) + " x " +
                             std::to_string(layout.size[2]) + " samples of " + std::string(name(layout.type)) + " are " +
                             std::to_string(bytes) + " bytes");
  }
  const std::shared_ptr<std::byte[]> samples = allocate_samples(path, bytes, options);
  ByteSource(path, layout.offset, Packing::none).read_samples(samples.get(), bytes);
  if (layout.big_endian != (std::endian::native == std::endian::big)) {
    swap_byte_order(samples.get(), bytes / sample_bytes, sample_bytes);
  }
  VolumeFile file;
  file.volume.grid.size = layout.size;
  file.volume.grid.spacing = {layout.spacing[0], layout.spacing[1], layout.spacing[2]};
  file.volume.type = layout.type;
  file.volume.samples = samples.get();
  file.volume.owner = samples;
  file.source.format = "headerless samples";
  return file;
}

}  // namespace isoatlas::io
