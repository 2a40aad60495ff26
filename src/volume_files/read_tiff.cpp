// SPDX-License-Identifier: Apache-2.0
// Reads a TIFF file as a volume: the stack that its description states, the choice of a channel and
// a time, and the samples.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "files/byte_source.h"
#include "files/file_error.h"
#include "files/stored_data.h"
#include "isoatlas/length_unit.h"
#include "volume_files/choice.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/readers.h"
#include "volume_files/rescale_samples.h"
#include "volume_files/tiff_spacing.h"
#include "volume_files/tiff_stack.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kMetaMorphStackTag =
    33629;  // UIC2Tag: one entry per plane of a stack in one page

TiffStack describe(TiffFile& tiff, const ReadOptions& options, VolumeSource& source) {
  tiff.select(0);
  if (tiff.page_count() == 1 && tiff.has_tag(kMetaMorphStackTag)) {
    throw unsupported(tiff.path(),
                      "is a MetaMorph stack (STK), which stores all planes in one page; Fiji can "
                      "save it as TIFF");
  }
  if (auto stack = describe_ome(tiff, options, source)) return std::move(*stack);
  if (auto stack = describe_imagej(tiff, source)) return std::move(*stack);
  if (auto stack = describe_scifio(tiff, source)) return std::move(*stack);
  if (auto stack = describe_lsm(tiff, source)) return std::move(*stack);
  return describe_pages(tiff, options, source);
}

// tifffile and Fiji label slices as channels or times unless the axes are given. ImageJ displays at
// most seven channels together, so more channels without slices are slices; up to seven are a 2-D
// image.
void take_only_axis_as_slices(TiffStack& stack, VolumeSource& source) {
  constexpr std::size_t kMostChannels = 7;
  const auto use = [&](std::size_t& axis, const std::string& label, auto page_of) {
    source.warnings.push_back("its " + std::to_string(axis) + " pages are labelled as " + label +
                              " of one slice each; they are read as slices");
    std::swap(axis, stack.slices);
    stack.page_of = page_of;
  };
  if (stack.slices > 1) {
    return;
  }
  if (stack.channels == 1 && stack.times > 1) {
    use(stack.times, "time points",
        [page_of = stack.page_of](std::size_t, std::size_t slice, std::size_t) {
          return page_of(0, 0, slice);
        });
  } else if (stack.channels > kMostChannels && stack.times == 1) {
    use(stack.channels, "channels",
        [page_of = stack.page_of](std::size_t, std::size_t slice, std::size_t) {
          return page_of(slice, 0, 0);
        });
    stack.channel_names.clear();
  }
}

void require_slices(const TiffStack& stack, const PageFormat& page, const fs::path& path) {
  if (stack.slices < 2) {
    const std::string what = stack.channels > 1 || stack.times > 1
                                 ? ", " + std::to_string(stack.channels) + " channels x " +
                                       std::to_string(stack.times) + " time points of 2-D images"
                                 : ", a 2-D image";
    throw unsupported(
        path, "has " + std::to_string(page.width) + " x " + std::to_string(page.height) +
                  " x 1 samples" + what +
                  "; expected a volume: a stack of slices, or the folder that holds all slices");
  }
}

/// The selected channel and time, as pages and the index of the value in each sample.
struct Selection {
  std::size_t page_channel = 0, value = 0, time = 0;
};

Selection select(const TiffStack& stack, const PageFormat& page,
                 const std::vector<std::string>& value_names, const fs::path& path,
                 const ReadOptions& options, VolumeSource& source) {
  const std::size_t values = page.values_per_sample;
  FileChoice channels = checked_choice(path, "channel", stack.channels * values);
  if (stack.channel_names.size() == channels.entries.size()) {
    channels.entries = stack.channel_names;
  } else if (stack.channels == 1) {
    channels.entries = value_names;
  }
  Selection selection;
  if (channels.entries.size() > 1) {
    const std::size_t channel = take_choice(path, source, std::move(channels), options.channel);
    selection = {channel / values, channel % values, 0};
  }
  if (stack.times > 1) {
    selection.time =
        take_choice(path, source, checked_choice(path, "time", stack.times), options.time);
  }
  return selection;
}

void describe_values(const PageFormat& page, const TiffFile& tiff, VolumeSource& source) {
  if (page.photometric == PHOTOMETRIC_MINISWHITE) {
    source.decisions.push_back({"photometric", "white is zero; samples are kept as stored"});
  } else if (page.photometric == PHOTOMETRIC_PALETTE) {
    source.decisions.push_back({"photometric", "palette; samples are its indices"});
  }
  if (tiff.orientation() != ORIENTATION_TOPLEFT) {
    source.warnings.push_back("states an orientation (" + std::to_string(tiff.orientation()) +
                              ") other than top left; rows and columns are kept as stored");
  }
  if (page.bits % 8 != 0) {
    source.decisions.push_back({"bits", std::to_string(page.bits) + " per sample, unpacked"});
  }
}

std::uint64_t stated_bytes(const PageFormat& page, std::uint64_t pages) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 62;
  return page.stored_bytes() > kMost / pages ? kMost : page.stored_bytes() * pages;
}

// LZW shrinks constant data by at most 5000. Zstandard and fax compression shrink it more, but need
// some bytes per page.
void require_possible_pages(const TiffFile& tiff, const PageFormat& page, std::size_t pages) {
  constexpr std::uint64_t kMostPerByte = 5000, kSmallestPage = 20;
  const bool is_packed_better =
      tiff.packs_without_bound() && tiff.file_size() / kSmallestPage >= pages;
  if (!is_packed_better) {
    require_possible_bytes(tiff.path(), stated_bytes(page, pages), tiff.file_size(), kMostPerByte);
  }
}

// Called before anything is allocated per page: a description may state any number of pages.
void require_images_behind_page(const TiffFile& tiff, const TiffStack& stack,
                                const PageFormat& page) {
  if (stack.is_contiguous) {
    const std::uint64_t start = tiff.offset_of_plain_samples();
    const std::uint64_t pages =
        stack.channels * stack.slices * stack.times;  // each at most a million
    require_stored_bytes(tiff.path(), stated_bytes(page, pages),
                         tiff.file_size() - std::min(start, tiff.file_size()));
  }
}

class SliceReader {
 public:
  SliceReader(TiffFile& tiff, const TiffStack& stack, const PageFormat& page,
              const ReadOptions& options)
      : tiff_(tiff), stack_(stack), page_(page), options_(options) {
    if (stack.is_contiguous) {
      start_ = tiff.offset_of_plain_samples();
    }
  }

  void read(const Selection& selection, std::size_t slice, std::byte* samples) {
    const std::size_t page = stack_.page_of(selection.page_channel, slice, selection.time);
    if (stack_.is_contiguous) {
      read_contiguous(page, selection.value, samples);
      return;
    }
    tiff_.select(page);
    if (const PageFormat format = tiff_.format(); !format.has_same_samples(page_)) {
      throw unsupported(tiff_.path(), "page " + std::to_string(page + 1) + " has " +
                                          to_string(format) + ", the first has " +
                                          to_string(page_));
    }
    tiff_.read_samples(page_, selection.value, options_, samples);
  }

 private:
  void read_contiguous(std::size_t page, std::size_t value, std::byte* samples) {
    stored_.resize(static_cast<std::size_t>(page_.stored_bytes()));
    ByteSource(tiff_.path(), start_ + page * page_.stored_bytes(), Packing::none)
        .read_samples(stored_.data(), stored_.size());
    const std::size_t value_bytes = page_.bits / 8;
    if (value_bytes > 1 && tiff_.is_big_endian() != (std::endian::native == std::endian::big)) {
      swap_byte_order(stored_.data(), stored_.size() / value_bytes, value_bytes);
    }
    const std::uint64_t stored_row = page_.stored_bytes() / page_.height;
    const std::uint64_t row_bytes = page_.width * bytes_per_sample(page_.type());
    for (std::uint32_t row = 0; row < page_.height; ++row) {
      unpack_values(page_, page_.values_per_sample, value, stored_.data() + row * stored_row,
                    page_.width, samples + row * row_bytes);
    }
  }

  TiffFile& tiff_;
  const TiffStack& stack_;
  PageFormat page_;
  const ReadOptions& options_;
  std::uint64_t start_ = 0;
  std::vector<std::byte> stored_;
};

Volume read_slices(TiffFile& tiff, const TiffStack& stack, const PageFormat& page,
                   const Selection& selection, const Vec3& spacing, const ReadOptions& options) {
  const fs::path& path = tiff.path();
  const std::array<std::size_t, 3> size{page.width, page.height, stack.slices};
  const SampleType type =
      stack.rescale ? rescaled_type(page.type(), stack.rescale->slope, stack.rescale->intercept)
                    : page.type();
  const std::uint64_t bytes = checked_sample_bytes(path, size, bytes_per_sample(type));
  require_possible_pages(tiff, page, stack.is_contiguous ? 1 : stack.slices);
  SliceReader reader(tiff, stack, page, options);
  Volume volume;
  volume.view.grid = grid_of_file(path, size, spacing, stack.origin,
                                  {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}});
  volume.view.grid.unit = stack.unit;
  volume.view.type = type;
  const std::shared_ptr<std::byte[]> samples = allocate_samples(path, bytes, options);
  const std::uint64_t slice_bytes = bytes / stack.slices;
  std::vector<std::byte> stored(
      stack.rescale ? static_cast<std::size_t>(size[0] * size[1] * bytes_per_sample(page.type()))
                    : 0);
  for (std::size_t slice = 0; slice < stack.slices; ++slice) {
    std::byte* const slice_samples = samples.get() + slice * slice_bytes;
    reader.read(selection, slice, stack.rescale ? stored.data() : slice_samples);
    if (stack.rescale) {
      rescale_samples(page.type(), stored.data(), size[0] * size[1], stack.rescale->slope,
                      stack.rescale->intercept, slice_samples);
    }
  }
  volume.view.samples = samples.get();
  volume.owner = samples;
  return volume;
}

}  // namespace

VolumeFile read_tiff(const fs::path& path, const ReadOptions& options) {
  TiffFile tiff(path);
  VolumeFile file;
  VolumeSource& source = file.source;
  source.format = "TIFF";
  source.reader = tiff.library_version();
  TiffStack stack = describe(tiff, options, source);
  source.format = stack.format;
  take_only_axis_as_slices(stack, source);
  const PageFormat page = tiff.format();
  require_slices(stack, page, path);
  require_images_behind_page(tiff, stack, page);
  const Selection selection = select(stack, page, tiff.value_names(), path, options, source);
  describe_values(page, tiff, source);
  const Vec3 spacing = take_spacing(stack, source);
  file.volume = read_slices(tiff, stack, page, selection, spacing, options);
  return file;
}

}  // namespace isoatlas::detail::io
