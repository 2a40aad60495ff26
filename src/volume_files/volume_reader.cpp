// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/volume_reader.h"

#include <algorithm>
#include <string>
#include <utility>

#include "core/require.h"
#include "files/mapped_file.h"
#include "files/sha256.h"
#include "volume_files/read_without_samples.h"

namespace isoatlas {
using namespace detail;

namespace {

constexpr std::uint64_t kBytesPerDigestStep = std::uint64_t{64} << 20;

}  // namespace

VolumeReader::VolumeReader(std::filesystem::path path, ReadOptions options)
    : path_(std::move(path)), options_(std::move(options)) {
  options_.map_samples = true;
  file_ = io::reads_boxes(path_, options_) ? io::read_without_samples(path_, options_)
                                           : read_volume_file(path_, options_);
}

Volume VolumeReader::box(const Size3& first, const Size3& last) const {
  for (std::size_t a = 0; a < 3; ++a) {
    require(first[a] < last[a] && last[a] < grid().size[a],
            "the box has samples " + std::to_string(first[a]) + " to " + std::to_string(last[a]) +
                " along " + "xyz"[a] + ", expected two or more of 0 to " +
                std::to_string(grid().size[a] - 1));
  }
  if (file_.volume.view.samples != nullptr) {
    Volume out = file_.volume;
    out.view = out.view.box(first, last);
    return out;
  }
  ReadOptions read = options_;
  read.map_samples = false;
  const Size3 begin = options_.region ? options_.region->first : Size3{0, 0, 0};
  Region& region = read.region.emplace();
  for (std::size_t a = 0; a < 3; ++a) {
    region.first[a] = begin[a] + first[a];
    region.last[a] = begin[a] + last[a];
  }
  return read_volume_file(path_, read).volume;
}

void VolumeReader::drop() const {
  const VolumeView& view = file_.volume.view;
  if (view.samples != nullptr)
    io::drop_mapped_pages(view.samples, view.grid.sample_count() * bytes_per_sample(view.type));
}

std::string VolumeReader::digest() const {
  const Size3& size = grid().size;
  const std::uint64_t layer = std::uint64_t{size[0]} * size[1] * bytes_per_sample(type());
  // Two layers at least: a region has no fewer.
  const std::size_t step =
      std::max<std::size_t>(2, static_cast<std::size_t>(kBytesPerDigestStep / layer));
  io::Sha256 digest;
  for (std::size_t z = 0; z < size[2]; z += step) {
    const std::size_t last = std::min(z + step, size[2]) - 1;
    const std::size_t first = std::min(z, size[2] - 2);
    const Volume part = box({0, 0, first}, {size[0] - 1, size[1] - 1, last});
    digest.add(static_cast<const std::byte*>(part.view.samples) + (z - first) * layer,
               (last - z + 1) * layer);
    drop();
  }
  return digest.digits();
}

}  // namespace isoatlas
