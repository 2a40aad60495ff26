// SPDX-License-Identifier: Apache-2.0
#include "volume_files/stored_samples.h"

#include <bzlib.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <span>
#include <string>

#include "files/file_error.h"
#include "files/stored_data.h"
#include "volume_files/grid_of_file.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

std::uint64_t count_of(std::span<const StoredAxis> axes) {
  std::uint64_t count = 1;
  for (const StoredAxis& axis : axes) {
    count *= axis.size;
  }
  return count;
}

bool has_selection(std::span<const StoredAxis> axes) {
  return std::ranges::any_of(axes,
                             [](const StoredAxis& axis) { return axis.selected.has_value(); });
}

/// All pieces as one run of samples.
class PieceSequence {
 public:
  PieceSequence(const fs::path& header_file, const StoredSamples& stored)
      : header_file_(header_file),
        stored_(stored),
        piece_samples_(count_of(stored.axes) / stored.pieces.size()) {}

  std::size_t sample_bytes() const { return bytes_per_sample(stored_.format.type); }

  void require_possible() const {
    for (const SamplePiece& piece : stored_.pieces) {
      check_data_file(header_file_, piece.file,
                      [&] { require_possible_piece(piece, stored_.format, piece_samples_); });
    }
  }

  void read(std::byte* to, std::uint64_t samples) {
    advance(samples, [&](std::uint64_t count) {
      reader_->read(to, count);
      to += count * sample_bytes();
    });
  }

  void skip(std::uint64_t samples) {
    advance(samples, [&](std::uint64_t count) { reader_->skip(count); });
  }

  /// A sentence about bytes after the samples; empty if no bytes follow.
  std::string rest() const {
    if (rest_bytes_ == 0) {
      return "";
    }
    const std::string more =
        std::to_string(rest_bytes_) + " bytes after the last sample that the header states";
    if (first_with_rest_ == header_file_) {
      return "has " + more;
    }
    return "its data file " + one_line(first_with_rest_.filename().string()) + " has " + more +
           (files_with_rest_ > 1
                ? ", and " + std::to_string(files_with_rest_ - 1) + " more files are longer too"
                : "");
  }

 private:
  template <class Use>
  void advance(std::uint64_t samples, Use use) {
    while (samples > 0) {
      const SamplePiece& piece = stored_.pieces[piece_];
      check_data_file(header_file_, piece.file, [&] {
        if (!reader_) {
          reader_ = open_piece(piece, stored_.format, piece_samples_);
        }
        const std::uint64_t count = std::min(samples, piece_samples_ - position_);
        use(count);
        samples -= count;
        position_ += count;
        if (position_ == piece_samples_) {
          close(piece);
        }
      });
    }
  }

  void close(const SamplePiece& piece) {
    if (const std::uint64_t bytes = reader_->count_rest(); bytes > 0) {
      if (++files_with_rest_ == 1) {
        first_with_rest_ = piece.file;
        rest_bytes_ = bytes;
      }
    }
    reader_.reset();
    position_ = 0;
    ++piece_;
  }

  const fs::path& header_file_;
  const StoredSamples& stored_;
  std::uint64_t piece_samples_;
  std::size_t piece_ = 0;
  std::uint64_t position_ = 0;  // samples read from the current piece
  std::unique_ptr<PieceReader> reader_;
  fs::path first_with_rest_;
  std::uint64_t rest_bytes_ = 0;
  std::size_t files_with_rest_ = 0;
};

/// Extracts the selected samples from a run of samples.
class SampleGatherer {
 public:
  SampleGatherer(PieceSequence& from, std::byte* to) : from_(from), to_(to) {}

  /// Reads one run along the fastest axes.
  void read(std::span<const StoredAxis> axes) {
    if (!has_selection(axes)) {
      const std::uint64_t count = count_of(axes);
      from_.read(to_, count);
      to_ += count * from_.sample_bytes();
      return;
    }
    const StoredAxis& slowest = axes.back();
    const std::span<const StoredAxis> faster = axes.first(axes.size() - 1);
    if (slowest.selected) {
      from_.skip(count_of(faster) * *slowest.selected);
      read(faster);
      from_.skip(count_of(faster) * (slowest.size - 1 - *slowest.selected));
    } else if (is_small(faster)) {
      read_strided(slowest.size, faster);
    } else {
      for (std::uint64_t i = 0; i < slowest.size; ++i) {
        read(faster);
      }
    }
  }

 private:
  static constexpr std::uint64_t kBufferBytes = std::uint64_t{1} << 16;

  // A run along several values of one sample is read as a whole: reading single values takes many
  // times as long.
  bool is_small(std::span<const StoredAxis> axes) const {
    return axes.back().selected && !has_selection(axes.first(axes.size() - 1)) &&
           count_of(axes) * from_.sample_bytes() <= kBufferBytes;
  }

  void read_strided(std::uint64_t blocks, std::span<const StoredAxis> block) {
    const std::uint64_t block_bytes = count_of(block) * from_.sample_bytes();
    const std::uint64_t run_bytes = block_bytes / block.back().size;
    const std::uint64_t most_blocks = kBufferBytes / block_bytes;
    buffer_.resize(kBufferBytes);
    for (std::uint64_t left = blocks; left > 0;) {
      const std::uint64_t count = std::min(left, most_blocks);
      from_.read(buffer_.data(), count * count_of(block));
      const std::byte* run = buffer_.data() + run_bytes * *block.back().selected;
      for (std::uint64_t i = 0; i < count; ++i, run += block_bytes, to_ += run_bytes) {
        std::memcpy(to_, run, run_bytes);
      }
      left -= count;
    }
  }

  PieceSequence& from_;
  std::byte* to_;
  std::vector<std::byte> buffer_;
};

std::string reader_name(Packing packing) {
  const std::string own = "isoatlas";
  switch (packing) {
    case Packing::deflate:
      return own + ", zlib " + zlibVersion();
    case Packing::bzip2:
      return own + ", bzip2 " +
             std::string(BZ2_bzlibVersion()).substr(0, std::string(BZ2_bzlibVersion()).find(','));
    default:
      return own;
  }
}

}  // namespace

std::uint64_t checked_sample_count(const fs::path& path, const std::vector<StoredAxis>& axes,
                                   SampleType type) {
  std::uint64_t count = 1;
  const std::uint64_t most =
      static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()) / bytes_per_sample(type);
  for (const StoredAxis& axis : axes) {
    if (axis.size == 0 || count > most / axis.size) {
      throw bad_file(path, axis.size == 0
                               ? "the size of an axis is 0, expected at least 1"
                               : "the header states more samples than any file can hold");
    }
    count *= axis.size;
  }
  return count;
}

std::shared_ptr<std::byte[]> read_stored_samples(const fs::path& header_file,
                                                 const StoredSamples& stored,
                                                 const ReadOptions& options, VolumeSource& source) {
  source.reader = reader_name(stored.pieces.front().packing);
  PieceSequence pieces(header_file, stored);
  pieces.require_possible();
  std::uint64_t count = 1;
  for (const StoredAxis& axis : stored.axes) {
    count *= axis.selected ? 1 : axis.size;
  }
  const bool is_text = stored.format.encoding == SampleEncoding::text;
  const bool is_swapped = !is_text && pieces.sample_bytes() > 1 &&
                          stored.is_big_endian != (std::endian::native == std::endian::big);
  const SamplePiece& first = stored.pieces.front();
  std::shared_ptr<std::byte[]> samples;
  if (stored.pieces.size() == 1 && stored.format.encoding == SampleEncoding::binary &&
      first.packing == Packing::none && !is_swapped && !has_selection(stored.axes))
    samples = mapped_samples(first.file, first.offset + first.skipped_bytes,
                             count * pieces.sample_bytes(), pieces.sample_bytes(), options);
  if (samples != nullptr) {
    pieces.skip(count);
  } else {
    samples = allocate_samples(header_file, count * pieces.sample_bytes(), options);
    SampleGatherer(pieces, samples.get()).read(stored.axes);
  }
  if (const std::string rest = pieces.rest(); !rest.empty()) {
    source.warnings.push_back(rest);
  }
  if (is_swapped) {
    swap_byte_order(samples.get(), count, pieces.sample_bytes());
  }
  return samples;
}

}  // namespace isoatlas::detail::io
