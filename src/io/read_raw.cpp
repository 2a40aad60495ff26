// SPDX-License-Identifier: Apache-2.0
// Headerless samples: the caller says what they are, the file's size must agree.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>

#include "io/file_error.h"
#include "io/formats.h"
#include "io/grid_of_file.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

namespace {

void reverse_bytes_of_each(std::byte* samples, std::uint64_t bytes, std::size_t sample_bytes) {
  for (std::uint64_t first = 0; first < bytes; first += sample_bytes) {
    std::reverse(samples + first, samples + first + sample_bytes);
  }
}

}  // namespace

Volume read_raw(const fs::path& path, const RawLayout& layout) {
  for (const double spacing : layout.spacing) {
    if (!std::isfinite(spacing) || spacing <= 0) {
      throw Error(ErrorCode::bad_argument,
                  one_line(path.string() + ": raw layout with spacing " + std::to_string(spacing) + ", expected positive lengths"));
    }
  }
  const std::size_t sample_bytes = bytes_per_sample(layout.type);
  const std::uint64_t bytes = checked_sample_bytes(path, layout.size, sample_bytes);
  const std::uint64_t file_bytes = readable_file_size(path);
  if (bytes != file_bytes) {
    throw bad_file(path, "has " + std::to_string(file_bytes) + " bytes, but " + std::to_string(layout.size[0]) + " x " +
                             std::to_string(layout.size[1]) + " x " + std::to_string(layout.size[2]) + " samples of " +
                             std::string(name(layout.type)) + " are " + std::to_string(bytes) + " bytes");
  }
  const std::shared_ptr<std::byte[]> samples = allocate_samples(path, bytes);
  std::ifstream stream(path, std::ios::binary);
  stream.read(reinterpret_cast<char*>(samples.get()), static_cast<std::streamsize>(bytes));
  if (static_cast<std::uint64_t>(stream.gcount()) != bytes) {
    throw bad_file(path, "cannot be read to its end");
  }
  if (layout.big_endian != (std::endian::native == std::endian::big)) {
    reverse_bytes_of_each(samples.get(), bytes, sample_bytes);
  }
  Volume volume;
  volume.grid.size = layout.size;
  volume.grid.spacing = {layout.spacing[0], layout.spacing[1], layout.spacing[2]};
  volume.type = layout.type;
  volume.samples = samples.get();
  volume.owner = samples;
  return volume;
}

}  // namespace isoatlas::io
