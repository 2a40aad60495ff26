// SPDX-License-Identifier: Apache-2.0
// Based on: DICOM PS3.5 section 8.1 (bits allocated, bits stored, high bit) and PS3.3 C.11.1.1.2
// (rescale).
#include "volume_files/dicom_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "files/byte_source.h"
#include "files/file_error.h"
#include "volume_files/dicom_codec.h"

namespace isoatlas::detail::io {

namespace {

bool is_rescaled(const DicomFrame& frame) { return frame.slope != 1 || frame.intercept != 0; }

bool is_whole(double value) {
  return value == std::floor(value) && std::abs(value) <= std::numeric_limits<std::int32_t>::max();
}

SampleType stored_type(const DicomSampleFormat& format) {
  if (format.is_float) {
    return format.bits_allocated == 32 ? SampleType::float32 : SampleType::float64;
  }
  switch (format.bits_allocated) {
    case 8:
      return format.is_signed ? SampleType::int8 : SampleType::uint8;
    case 16:
      return format.is_signed ? SampleType::int16 : SampleType::uint16;
    default:
      return format.is_signed ? SampleType::int32 : SampleType::uint32;
  }
}

struct Range {
  double low = 0, high = 0;
};

// The range of values that the samples of a frame can have.
Range range_of(const DicomFrame& frame) {
  const DicomSampleFormat& format = frame.image->format;
  const double values = std::ldexp(1.0, static_cast<int>(format.bits_stored));
  const double low = format.is_signed ? -values / 2 : 0,
               high = format.is_signed ? values / 2 - 1 : values - 1;
  const double first = frame.slope * low + frame.intercept,
               last = frame.slope * high + frame.intercept;
  return {std::min(first, last), std::max(first, last)};
}

template <class Type>
bool holds(const Range& range) {
  return range.low >= std::numeric_limits<Type>::min() &&
         range.high <= std::numeric_limits<Type>::max();
}

SampleType smallest_type(const Range& range) {
  if (range.low >= 0) {
    return holds<std::uint8_t>(range)    ? SampleType::uint8
           : holds<std::uint16_t>(range) ? SampleType::uint16
           : holds<std::uint32_t>(range) ? SampleType::uint32
                                         : SampleType::float64;
  }
  return holds<std::int8_t>(range)    ? SampleType::int8
         : holds<std::int16_t>(range) ? SampleType::int16
         : holds<std::int32_t>(range) ? SampleType::int32
                                      : SampleType::float64;
}

// Keeps only the stored bits of integers: the other allocated bits hold overlays in old files.
template <class Cell>
void keep_stored_bits(const DicomSampleFormat& format, Cell* samples, std::size_t count) {
  const unsigned unused = format.bits_allocated - format.bits_stored;
  const unsigned above = format.bits_allocated - 1 - format.high_bit;
  for (std::size_t i = 0; i < count; ++i) {
    const auto raised = static_cast<std::make_unsigned_t<Cell>>(
        static_cast<std::make_unsigned_t<Cell>>(samples[i]) << above);
    samples[i] =
        static_cast<Cell>(static_cast<Cell>(raised) >> unused);  // keeps the sign of signed types
  }
}

template <class Stored, class Sample>
void convert(const DicomFrame& frame, const Stored* stored, std::size_t count, Sample* samples) {
  const double slope = frame.slope, intercept = frame.intercept;
  for (std::size_t i = 0; i < count; ++i) {
    samples[i] = static_cast<Sample>(slope * static_cast<double>(stored[i]) + intercept);
  }
}

template <class Use>
void with_cell(const DicomSampleFormat& format, std::byte* cells, Use use) {
  switch (stored_type(format)) {
    case SampleType::uint8:
      return use(reinterpret_cast<std::uint8_t*>(cells));
    case SampleType::int8:
      return use(reinterpret_cast<std::int8_t*>(cells));
    case SampleType::uint16:
      return use(reinterpret_cast<std::uint16_t*>(cells));
    case SampleType::int16:
      return use(reinterpret_cast<std::int16_t*>(cells));
    case SampleType::uint32:
      return use(reinterpret_cast<std::uint32_t*>(cells));
    case SampleType::int32:
      return use(reinterpret_cast<std::int32_t*>(cells));
    case SampleType::float32:
      return use(reinterpret_cast<float*>(cells));
    default:
      return use(reinterpret_cast<double*>(cells));
  }
}

template <class Use>
void with_sample(SampleType type, std::byte* samples, Use use) {
  switch (type) {
    case SampleType::uint8:
      return use(reinterpret_cast<std::uint8_t*>(samples));
    case SampleType::int8:
      return use(reinterpret_cast<std::int8_t*>(samples));
    case SampleType::uint16:
      return use(reinterpret_cast<std::uint16_t*>(samples));
    case SampleType::int16:
      return use(reinterpret_cast<std::int16_t*>(samples));
    case SampleType::uint32:
      return use(reinterpret_cast<std::uint32_t*>(samples));
    case SampleType::int32:
      return use(reinterpret_cast<std::int32_t*>(samples));
    case SampleType::float32:
      return use(reinterpret_cast<float*>(samples));
    default:
      return use(reinterpret_cast<double*>(samples));
  }
}

/// Reads frames of one file after another; a file stays open while its frames are read.
class FrameReader {
 public:
  explicit FrameReader(std::uint64_t max_memory) : max_memory_(max_memory) {}

  /// The allocated samples of the frame as stored, decompressed and in the machine's byte order.
  void read(const DicomFrame& frame, std::byte* cells) {
    if (image_ != frame.image) {
      image_ = frame.image;
      bytes_.emplace(open_dicom(image_->path, max_memory_));
      streams_.clear();
      if (image_->pixels.is_compressed) {
        streams_ = fragments_of_frames(*bytes_, *image_);
      }
    }
    if (image_->pixels.is_compressed) {
      decode_frame(*image_, frame.number, stream_of(frame.number), cells);
    } else {
      read_plain(frame.number, cells);
    }
  }

 private:
  void require(std::uint64_t offset, std::uint64_t count) const {
    if (offset > bytes_->size() || count > bytes_->size() - offset) {
      throw bad_file(image_->path, "has become shorter while it was read");
    }
  }

  std::string stream_of(std::size_t number) {
    std::string stream;
    for (const DicomPixels::Fragment& fragment : streams_[number]) {
      require(fragment.offset, fragment.bytes);
      const std::size_t start = stream.size();
      stream.resize(start + static_cast<std::size_t>(fragment.bytes));
      bytes_->read(fragment.offset, stream.data() + start, fragment.bytes);
    }
    return stream;
  }

  void read_plain(std::size_t number, std::byte* cells) {
    const std::size_t cell_bytes = image_->format.bits_allocated / 8;
    const std::uint64_t count = std::uint64_t{image_->rows} * image_->columns;
    const std::uint64_t offset = image_->pixels.offset + number * count * cell_bytes;
    // In big-endian words the two bytes of a word are swapped; a frame with an odd number of bytes
    // begins or ends within a word.
    if (image_->is_big_endian && cell_bytes == 1 && image_->pixels.is_words) {
      read_bytes_of_words(number * count, count, cells);
      return;
    }
    require(offset, count * cell_bytes);
    bytes_->read(offset, cells, count * cell_bytes);
    if (image_->is_big_endian && cell_bytes > 1) {
      swap_byte_order(cells, count, cell_bytes);
    }
  }

  void read_bytes_of_words(std::uint64_t first, std::uint64_t count, std::byte* cells) {
    const std::uint64_t start = first / 2 * 2, end = (first + count + 1) / 2 * 2;
    require(image_->pixels.offset + start, end - start);
    std::string words(static_cast<std::size_t>(end - start), '\0');
    bytes_->read(image_->pixels.offset + start, words.data(), words.size());
    swap_byte_order(words.data(), words.size() / 2, 2);
    std::memcpy(cells, words.data() + (first - start), static_cast<std::size_t>(count));
  }

  std::uint64_t max_memory_;
  std::shared_ptr<const DicomImage> image_;
  std::optional<DicomBytes> bytes_;
  std::vector<std::vector<DicomPixels::Fragment>> streams_;
};

}  // namespace

SampleType dicom_sample_type(const std::vector<DicomFrame>& frames) {
  const SampleType first = stored_type(frames.front().image->format);
  bool is_stored_type = true, is_fractional = false;
  Range range = range_of(frames.front());
  for (const DicomFrame& frame : frames) {
    is_stored_type =
        is_stored_type && !is_rescaled(frame) && stored_type(frame.image->format) == first;
    is_fractional = is_fractional || frame.image->format.is_float || !is_whole(frame.slope) ||
                    !is_whole(frame.intercept);
    const Range own = range_of(frame);
    range = {std::min(range.low, own.low), std::max(range.high, own.high)};
  }
  return is_stored_type ? first : is_fractional ? SampleType::float64 : smallest_type(range);
}

void read_dicom_samples(const std::vector<DicomFrame>& frames, SampleType type,
                        std::uint64_t max_memory, std::byte* samples) {
  FrameReader reader(max_memory);
  std::vector<std::byte> buffer;
  for (const DicomFrame& frame : frames) {
    const DicomSampleFormat& format = frame.image->format;
    const std::size_t count = frame.image->rows * frame.image->columns;
    const bool is_stored_type = type == stored_type(format) && !is_rescaled(frame);
    if (!is_stored_type) {
      buffer.resize(count * (format.bits_allocated / 8));
    }
    std::byte* const cells = is_stored_type ? samples : buffer.data();
    reader.read(frame, cells);
    with_cell(format, cells, [&](auto* stored) {
      using Cell = std::remove_pointer_t<decltype(stored)>;
      if constexpr (std::is_integral_v<Cell>) {
        if (format.bits_stored != format.bits_allocated) keep_stored_bits(format, stored, count);
      }
      if (!is_stored_type) {
        with_sample(type, samples, [&](auto* made) { convert(frame, stored, count, made); });
      }
    });
    samples += count * bytes_per_sample(type);
  }
}

}  // namespace isoatlas::detail::io
