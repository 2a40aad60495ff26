// SPDX-License-Identifier: Apache-2.0
// Based on: DICOM PS3.5 annex A.4 (compressed pixel data) and annex G (RLE); ITU-T T.81 annex B
// (JPEG markers), T.87 (JPEG-LS), T.800 annex A (JPEG 2000 codestream).
#include "volume_files/dicom_codec.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "files/file_error.h"
#include "volume_files/dicom_decoders.h"

namespace isoatlas::detail::io {

namespace {

enum class Family { none, jpeg, jpeg_ls, jpeg_2000, rle };

struct Compression {
  std::string_view syntax, name;
  Family family;
};

constexpr std::array kCompressions{
    Compression{"1.2.840.10008.1.2.4.50", "JPEG", Family::jpeg},
    Compression{"1.2.840.10008.1.2.4.51", "JPEG", Family::jpeg},
    Compression{"1.2.840.10008.1.2.4.53", "JPEG", Family::jpeg},
    Compression{"1.2.840.10008.1.2.4.55", "JPEG", Family::jpeg},
    Compression{"1.2.840.10008.1.2.4.57", "JPEG lossless", Family::jpeg},
    Compression{"1.2.840.10008.1.2.4.70", "JPEG lossless", Family::jpeg},
    Compression{"1.2.840.10008.1.2.4.80", "JPEG-LS", Family::jpeg_ls},
    Compression{"1.2.840.10008.1.2.4.81", "JPEG-LS, near lossless", Family::jpeg_ls},
    Compression{"1.2.840.10008.1.2.4.90", "JPEG 2000 lossless", Family::jpeg_2000},
    Compression{"1.2.840.10008.1.2.4.91", "JPEG 2000", Family::jpeg_2000},
    Compression{"1.2.840.10008.1.2.5", "RLE", Family::rle}};

const Compression* compression_of(const std::string& transfer_syntax) {
  const auto* found =
      std::ranges::find(kCompressions, std::string_view(transfer_syntax), &Compression::syntax);
  return found == kCompressions.end() ? nullptr : found;
}

Family family_of(const DicomImage& image) {
  const Compression* compression = compression_of(image.transfer_syntax);
  return compression == nullptr ? Family::none : compression->family;
}

constexpr std::string_view kCodestreamStart{"\xFF\x4F\xFF\x51", 4};

/// The properties that the header of a compressed stream states.
struct StreamHeader {
  std::size_t columns = 0, rows = 0;
  unsigned components = 0, bits = 0;
  bool is_signed = false;
};

std::size_t big_endian(std::string_view bytes, std::size_t at, std::size_t count) {
  std::size_t value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    value = value << 8U | static_cast<unsigned char>(bytes[at + i]);
  }
  return value;
}

// Reads the first frame header of a JPEG or JPEG-LS stream. False if the stream has none.
bool read_jpeg_header(std::string_view stream, StreamHeader& header) {
  std::size_t at = 2;
  if (!stream.starts_with("\xFF\xD8")) {
    return false;
  }
  while (at + 4 <= stream.size() && stream[at] == '\xFF') {
    const auto marker = static_cast<unsigned char>(stream[at + 1]);
    const bool is_fill = marker == 0xFF;
    const bool is_frame =
        (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC) ||
        marker == 0xF7;
    if (is_frame && at + 10 <= stream.size()) {
      header = {big_endian(stream, at + 7, 2), big_endian(stream, at + 5, 2),
                static_cast<unsigned char>(stream[at + 9]),
                static_cast<unsigned char>(stream[at + 4]), false};
      return true;
    }
    at += is_fill ? 1 : 2 + big_endian(stream, at + 2, 2);
  }
  return false;
}

// Reads the SIZ segment of a JPEG 2000 stream. Refuses images that do not begin at the origin of
// the reference grid or are subsampled.
bool read_codestream_header(std::string_view stream, StreamHeader& header) {
  const std::size_t start = stream.find(kCodestreamStart);
  if (start == std::string_view::npos || stream.size() < start + 45) {
    return false;
  }
  stream.remove_prefix(start);
  const auto field = [&](std::size_t at) { return big_endian(stream, at, 4); };
  const bool starts_at_corner =
      field(16) == 0 && field(20) == 0 && field(32) == 0 && field(36) == 0;
  const auto depth = static_cast<unsigned char>(stream[42]);
  const bool is_full = stream[43] == 1 && stream[44] == 1;
  header = {field(8), field(12), static_cast<unsigned>(big_endian(stream, 40, 2)),
            (depth & 0x7FU) + 1U, (depth & 0x80U) != 0};
  return starts_at_corner && is_full;
}

// Returns a description of the problem; empty without a problem.
std::string read_header(Family family, std::string_view stream, const DicomImage& image,
                        StreamHeader& header) {
  const bool is_read = family == Family::jpeg_2000 ? read_codestream_header(stream, header)
                                                   : read_jpeg_header(stream, header);
  if (!is_read) {
    return "has a compressed frame that is not a " + compression_name(image.transfer_syntax) +
           " image";
  }
  if (header.columns != image.columns || header.rows != image.rows || header.components != 1) {
    return "has a compressed frame of " + std::to_string(header.columns) + " x " +
           std::to_string(header.rows) + " with " + std::to_string(header.components) +
           " components, but states " + std::to_string(image.columns) + " x " +
           std::to_string(image.rows) + " with 1";
  }
  return {};
}

unsigned allocated_for(unsigned bits) { return bits <= 8 ? 8 : bits <= 16 ? 16 : 32; }

// The stream as its decoder requires it: for JPEG 2000, the codestream without a file format around
// it, up to its end marker. Empty if it is cut off.
std::string whole_stream(Family family, const std::string& stream) {
  const std::size_t start = family == Family::jpeg_2000 ? stream.find(kCodestreamStart) : 0;
  const std::size_t end = stream.rfind("\xFF\xD9");
  constexpr std::size_t kMostPadding = 16;
  if (start == std::string::npos || end == std::string::npos || end < start ||
      stream.size() - end > kMostPadding) {
    return {};
  }
  return stream.substr(start, end + 2 - start);
}

}  // namespace

bool can_decode(const std::string& transfer_syntax) {
  return compression_of(transfer_syntax) != nullptr;
}

std::string compression_name(const std::string& transfer_syntax) {
  const Compression* compression = compression_of(transfer_syntax);
  return compression == nullptr ? transfer_syntax : std::string(compression->name);
}

std::string adapt_to_stream(DicomBytes& bytes, DicomImage& image) {
  const Family family = family_of(image);
  if (family == Family::rle) {
    return {};
  }
  constexpr std::uint64_t kHeaderBytes =
      std::uint64_t{1} << 17;  // a profile or a comment may precede the frame header
  const DicomPixels::Fragment& first = image.pixels.fragments.front();
  StreamHeader header;
  std::string problem = read_header(
      family, bytes.at(first.offset, static_cast<std::size_t>(std::min(first.bytes, kHeaderBytes))),
      image, header);
  DicomSampleFormat& format = image.format;
  if (problem.empty() && (header.bits < 2 || header.bits > 32 ||
                          (family == Family::jpeg && header.bits > format.bits_allocated))) {
    problem = "has compressed samples of " + std::to_string(header.bits) + " bits, but states " +
              std::to_string(format.bits_allocated);
  }
  if (!problem.empty()) {
    return problem;
  }
  const bool is_free = family == Family::jpeg_2000 && header.is_signed == format.is_signed;
  format.bits_allocated = allocated_for(header.bits);
  const bool is_in_upper_bits =
      format.high_bit + 1 > format.bits_stored && header.bits > format.high_bit;
  if (is_in_upper_bits) {  // the stream holds all allocated bits
    return {};
  }
  format.bits_stored = is_free ? header.bits : std::min(format.bits_stored, header.bits);
  format.high_bit = format.bits_stored - 1;
  return {};
}

std::vector<std::vector<DicomPixels::Fragment>> fragments_of_frames(DicomBytes& bytes,
                                                                    const DicomImage& image) {
  const std::vector<DicomPixels::Fragment>& fragments = image.pixels.fragments;
  const std::vector<std::uint32_t>& offsets = image.pixels.frame_offsets;
  std::vector<std::vector<DicomPixels::Fragment>> frames;
  bool is_clear = true;
  std::vector<std::uint32_t> sorted_offsets = offsets;
  std::ranges::sort(sorted_offsets);
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const std::uint64_t fragment_offset = fragments[i].offset - fragments[0].offset;
    const std::string_view start =
        fragments[i].bytes >= 4 ? bytes.at(fragments[i].offset, 4) : std::string_view();
    const bool starts_image = start.starts_with("\xFF\xD8\xFF") || start == kCodestreamStart;
    const bool starts_frame = i == 0 || fragments.size() == image.frames ||
                              (offsets.size() == image.frames
                                   ? std::ranges::binary_search(sorted_offsets, fragment_offset)
                                   : starts_image);
    is_clear = is_clear && (starts_frame || !starts_image);
    if (starts_frame) {
      frames.emplace_back();
    }
    frames.back().push_back(fragments[i]);
  }
  if (!is_clear || frames.size() != image.frames) {
    throw bad_file(image.path, "has " + std::to_string(fragments.size()) +
                                   " compressed fragments, which cannot be assigned to its " +
                                   std::to_string(image.frames) + " frames");
  }
  return frames;
}

void decode_frame(const DicomImage& image, std::size_t frame, const std::string& stream,
                  void* samples) {
  const Family family = family_of(image);
  auto* to = static_cast<char*>(samples);
  FrameSize size{image.columns, image.rows, image.format.bits_allocated, image.format.is_signed};
  bool is_decoded = false;
  if (family == Family::rle) {
    is_decoded = decode_run_lengths(stream, size, to);
  } else {
    StreamHeader header;
    if (const std::string problem = read_header(family, stream, image, header); !problem.empty()) {
      throw bad_file(image.path, problem);
    }
    size.bits = header.bits;
    const std::string whole = whole_stream(family, stream);
    const auto decode = family == Family::jpeg      ? decode_jpeg
                        : family == Family::jpeg_ls ? decode_jpeg_ls
                                                    : decode_jpeg_2000;
    is_decoded = allocated_for(header.bits) == image.format.bits_allocated && !whole.empty() &&
                 decode(whole, size, to);
  }
  if (!is_decoded) {
    throw bad_file(image.path, "is damaged: frame " + std::to_string(frame + 1) + " of its " +
                                   compression_name(image.transfer_syntax) +
                                   " images cannot be decoded to its end");
  }
}

std::string decoder_name(const DicomImage& image) {
  switch (image.pixels.is_compressed ? family_of(image) : Family::none) {
    case Family::jpeg:
      return jpeg_decoder_name();
    case Family::jpeg_ls:
      return jpeg_ls_decoder_name();
    case Family::jpeg_2000:
      return jpeg_2000_decoder_name();
    default:
      return "isoatlas";
  }
}

}  // namespace isoatlas::detail::io
