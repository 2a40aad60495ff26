// SPDX-License-Identifier: Apache-2.0
// Based on: DICOM PS3.5 section 7 (data elements, sequences, items) and annex A (transfer
// syntaxes), PS3.10 section 7 (preamble, file meta group).
#include "volume_files/dicom_contents.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <new>
#include <utility>

#include "files/byte_source.h"
#include "files/file_error.h"

namespace isoatlas::detail::io {

static_assert(std::endian::native == std::endian::little, "values are kept little-endian");

namespace fs = std::filesystem;
using namespace dicom;

namespace {

constexpr std::size_t kPreamble = 128;
constexpr std::string_view kDicomMark = "DICM";
constexpr std::uint32_t kUndefinedLength = 0xFFFF'FFFFU;
constexpr DicomTag kItem = 0xFFFE'E000U, kItemEnd = 0xFFFE'E00DU, kSequenceEnd = 0xFFFE'E0DDU;
constexpr int kDeepestNesting = 64;
constexpr std::string_view kExplicitBig = "1.2.840.10008.1.2.2",
                           kDeflated = "1.2.840.10008.1.2.1.99",
                           kGeBigEndianSamples = "1.2.840.113619.5.2";

bool is_pixel_data(DicomTag tag) {
  return tag == kPixelData || tag == kFloatPixelData || tag == kDoublePixelData;
}

}  // namespace

DicomBytes::DicomBytes(const fs::path& path)
    : path_(path),
      file_(std::make_unique<std::ifstream>(path, std::ios::binary)),
      size_(readable_file_size(path)) {}

DicomBytes::DicomBytes(std::string bytes) : window_(std::move(bytes)), size_(window_.size()) {}

std::string_view DicomBytes::at(std::uint64_t offset, std::size_t count) {
  constexpr std::uint64_t kWindow = std::uint64_t{1} << 14;
  if (offset < window_start_ || offset + count > window_start_ + window_.size()) {
    window_.resize(static_cast<std::size_t>(
        std::min(std::max<std::uint64_t>(count, kWindow), size_ - offset)));
    window_start_ = offset;
    read(offset, window_.data(), window_.size());
  }
  return std::string_view(window_).substr(static_cast<std::size_t>(offset - window_start_), count);
}

void DicomBytes::read(std::uint64_t offset, void* to, std::uint64_t count) {
  if (file_ == nullptr) {
    std::memcpy(to, window_.data() + offset, static_cast<std::size_t>(count));
    return;
  }
  file_->clear();
  file_->seekg(static_cast<std::streamoff>(offset));
  file_->read(static_cast<char*>(to), static_cast<std::streamsize>(count));
  if (static_cast<std::uint64_t>(file_->gcount()) != count) {
    throw bad_file(path_, "cannot be read to its end");
  }
}

namespace {

struct Header {
  DicomTag tag = 0;
  std::string type;  // empty if the file does not state it
  std::uint32_t length = 0;
};

// Reasons to stop before the end of the pixel data. Thrown inside this file only.
struct CutOff {};
struct InvalidElements {};

class Parser {
 public:
  Parser(DicomBytes& bytes, DicomContents& contents) : bytes_(bytes), contents_(contents) {}

  // Reads the preamble and the file meta group, which have explicit types and are little-endian.
  // Returns the offset of the data set.
  std::uint64_t parse_meta_group() {
    const bool has_mark = bytes_.size() >= kPreamble + kDicomMark.size() &&
                          bytes_.at(kPreamble, kDicomMark.size()) == kDicomMark;
    position_ = has_mark ? kPreamble + kDicomMark.size() : 0;
    is_explicit_ = true;
    while (position_ + 2 <= bytes_.size() && group_at(position_, false) == 0x0002) {
      const Header header = next_header();
      if (header.length == kUndefinedLength) {
        throw InvalidElements{};
      }
      if (header.tag == kTransferSyntax) {
        contents_.transfer_syntax = std::string(dicom_trimmed(value(header.length)));
      } else {
        skip(header.length);
      }
    }
    return position_;
  }

  void parse_data_set(std::uint64_t start) {
    position_ = start;
    find_encoding();
    while (position_ < bytes_.size()) {
      const Header header = next_header();
      if (header.tag == 0) {
        return;  // padding
      }
      if (is_pixel_data(header.tag)) {
        locate_pixels(header);
        return;
      }
      parse_element(header, contents_.attributes, 0);
    }
  }

 private:
  // Compares the transfer syntax with the first data element: some writers state explicit types and
  // write implicit ones, or the reverse.
  void find_encoding() {
    const std::string& syntax = contents_.transfer_syntax;
    is_big_endian_ = syntax == kExplicitBig;
    if (position_ + 8 > bytes_.size()) {
      throw CutOff{};
    }
    if (syntax.empty()) {
      is_big_endian_ = group_at(position_, false) > 0x00FF && group_at(position_, true) <= 0x00FF;
    }
    is_explicit_ = is_type(bytes_.at(position_ + 4, 2));
    contents_.is_big_endian = is_big_endian_ || syntax == kGeBigEndianSamples;
  }

  static bool is_type(std::string_view text) {
    return std::ranges::all_of(text, [](char c) { return c >= 'A' && c <= 'Z'; });
  }

  template <class Number>
  Number number_at(std::uint64_t position, bool big_endian) {
    if (position + sizeof(Number) > bytes_.size()) {
      throw CutOff{};
    }
    Number value{};
    std::memcpy(&value, bytes_.at(position, sizeof value).data(), sizeof value);
    if (big_endian) {
      swap_byte_order(&value, 1, sizeof value);
    }
    return value;
  }

  std::uint16_t group_at(std::uint64_t position, bool big_endian) {
    return number_at<std::uint16_t>(position, big_endian);
  }

  void skip(std::uint64_t count) {
    if (count > bytes_.size() - position_) {
      throw CutOff{};
    }
    position_ += count;
  }

  std::string value(std::uint64_t count) {
    const std::uint64_t start = position_;
    skip(count);
    std::string bytes(static_cast<std::size_t>(count), '\0');
    bytes_.read(start, bytes.data(), count);
    return bytes;
  }

  // Reads a tag, a type and a length, and moves the position to the value.
  Header next_header() {
    const DicomTag group = number_at<std::uint16_t>(position_, is_big_endian_);
    Header header{group << 16U | number_at<std::uint16_t>(position_ + 2, is_big_endian_), {}, 0};
    const bool is_delimiter = group == 0xFFFE;  // never has a type
    if (position_ + 8 > bytes_.size()) {
      throw CutOff{};
    }
    const std::string type(bytes_.at(position_ + 4, 2));
    if (is_delimiter || !is_explicit_ || !is_type(type)) {
      header.length = number_at<std::uint32_t>(position_ + 4, is_big_endian_);
      skip(8);
      return header;
    }
    constexpr std::string_view kShortTypes =
        "AE AS AT CS DA DS DT FD FL IS LO LT PN SH SL SS ST TM UI UL US";
    const bool is_short = kShortTypes.find(type) != std::string_view::npos;
    header.type = type;
    header.length = is_short ? number_at<std::uint16_t>(position_ + 6, is_big_endian_)
                             : number_at<std::uint32_t>(position_ + 8, is_big_endian_);
    skip(is_short ? 8 : 12);
    return header;
  }

  void parse_element(const Header& header, DicomDataSet& into, int depth) {
    if (header.tag == kPixelData && header.length == kUndefinedLength) {  // pixel data of an icon
      DicomPixels not_used;
      locate_fragments(not_used);
      return;
    }
    const std::string_view known = dicom_type(header.tag);
    const bool is_sequence =
        header.type == "SQ" || known == "SQ" || header.length == kUndefinedLength;
    if (known.empty() ? header.length != kUndefinedLength : !is_sequence) {
      if (known.empty()) {
        skip(header.length);
        return;
      }
      DicomAttribute attribute{
          header.tag,
          header.type.empty() || header.type == "UN" ? std::string(known) : header.type,
          value(header.length),
          {}};
      if (const std::size_t bytes = dicom_value_bytes(attribute.type);
          is_big_endian_ && bytes > 0) {
        swap_byte_order(attribute.value.data(), attribute.value.size() / bytes, bytes);
      }
      into.add(std::move(attribute));
      return;
    }
    // A sequence whose type the writer did not know is implicit and little-endian inside, whatever
    // the encoding of the file.
    const bool was_explicit = is_explicit_, was_big_endian = is_big_endian_;
    if (header.type == "UN") {
      is_explicit_ = is_big_endian_ = false;
    }
    DicomAttribute sequence{header.tag, "SQ", {}, {}};
    parse_items(header.length, sequence.items, depth);
    is_explicit_ = was_explicit;
    is_big_endian_ = was_big_endian;
    if (!known.empty()) {
      into.add(std::move(sequence));
    }
  }

  void parse_items(std::uint32_t length, std::vector<DicomDataSet>& items, int depth) {
    if (depth > kDeepestNesting) {
      throw InvalidElements{};
    }
    const std::uint64_t end = end_of(length);
    while (position_ < end) {
      const Header header = next_header();
      if (header.tag == kSequenceEnd && length == kUndefinedLength) {
        return;
      }
      if (header.tag != kItem) {
        throw InvalidElements{};
      }
      items.emplace_back();
      parse_item(header.length, items.back(), depth);
    }
    require_end(length, end);
  }

  void parse_item(std::uint32_t length, DicomDataSet& item, int depth) {
    const std::uint64_t end = end_of(length);
    while (position_ < end) {
      const Header header = next_header();
      if (header.tag == kItemEnd && length == kUndefinedLength) {
        return;
      }
      parse_element(header, item, depth + 1);
    }
    require_end(length, end);
  }

  std::uint64_t end_of(std::uint32_t length) {
    if (length == kUndefinedLength) {
      return bytes_.size();
    }
    if (length > bytes_.size() - position_) {
      throw CutOff{};
    }
    return position_ + length;
  }

  void require_end(std::uint32_t length, std::uint64_t end) {
    if (length == kUndefinedLength) {
      throw CutOff{};  // the delimiter is missing
    }
    if (position_ != end) {
      throw InvalidElements{};
    }
  }

  void locate_pixels(const Header& header) {
    DicomPixels& pixels = contents_.pixels.emplace();
    pixels.tag = header.tag;
    pixels.is_words = header.type == "OW";
    pixels.is_compressed = header.length == kUndefinedLength;
    pixels.offset = position_;
    pixels.bytes = header.length;
    if (pixels.is_compressed) {
      pixels.bytes = 0;
      locate_fragments(pixels);
    } else {
      skip(header.length);
    }
  }

  void locate_fragments(DicomPixels& pixels) {
    bool is_offset_table = true;
    for (Header item = next_header(); item.tag != kSequenceEnd; item = next_header()) {
      if (item.tag != kItem || item.length == kUndefinedLength) {
        throw InvalidElements{};
      }
      const std::uint64_t start = position_;
      if (is_offset_table) {
        const std::string table = value(item.length);
        for (std::size_t at = 0; at + sizeof(std::uint32_t) <= table.size();
             at += sizeof(std::uint32_t)) {
          std::memcpy(&pixels.frame_offsets.emplace_back(), table.data() + at,
                      sizeof(std::uint32_t));
        }
      } else {
        skip(item.length);
        pixels.fragments.push_back({start, item.length});
        pixels.bytes += item.length;
      }
      is_offset_table = false;
    }
  }

  DicomBytes& bytes_;
  DicomContents& contents_;
  std::uint64_t position_ = 0;
  bool is_explicit_ = true;
  bool is_big_endian_ = false;
};

// Decompresses the data from `start` on. A deflated data set has neither header nor checksum.
std::string inflated_rest(const fs::path& path, DicomBytes& bytes, std::uint64_t start,
                          std::uint64_t max_memory) {
  std::string packed(static_cast<std::size_t>(bytes.size() - start), '\0');
  bytes.read(start, packed.data(), packed.size());
  z_stream stream{};
  constexpr int kNoHeader = -15;
  if (inflateInit2(&stream, kNoHeader) != Z_OK) {
    throw std::bad_alloc();
  }
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end_inflation(&stream, inflateEnd);
  std::string unpacked;
  std::vector<char> chunk(std::size_t{1} << 18);
  stream.next_in = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  int result = Z_OK;
  while (result == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
    stream.avail_out = static_cast<uInt>(chunk.size());
    result = inflate(&stream, Z_NO_FLUSH);
    unpacked.append(chunk.data(), chunk.size() - stream.avail_out);
    if (unpacked.size() > max_memory) {
      throw Error(ErrorCode::out_of_memory,
                  one_line(path.string() + ": its deflated data set is larger than the limit of " +
                           std::to_string(max_memory) + " bytes"));
    }
  }
  if (result != Z_STREAM_END) {
    throw bad_file(path, "its deflated data set is damaged or cut off after " +
                             std::to_string(unpacked.size()) + " bytes");
  }
  return unpacked;
}

// The bytes of the file, decompressed if necessary, and the offset of its data set.
DicomBytes open_with_start(const fs::path& path, std::uint64_t max_memory, DicomContents& contents,
                           std::uint64_t& start) {
  DicomBytes bytes(path);
  start = Parser(bytes, contents).parse_meta_group();
  if (contents.transfer_syntax != kDeflated) {
    return bytes;
  }
  std::string all(bytes.at(0, static_cast<std::size_t>(start)));
  all += inflated_rest(path, bytes, start, max_memory);
  return DicomBytes(std::move(all));
}

std::string start_of(const fs::path& path) {
  std::string start(kPreamble + kDicomMark.size(), '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  return start;
}

}  // namespace

bool has_dicom_mark(const fs::path& path) {
  const std::string start = start_of(path);
  return start.size() > kPreamble && start.substr(kPreamble) == kDicomMark;
}

bool looks_like_dicom(const fs::path& path) {
  const std::string start = start_of(path);
  const std::string_view bytes = start;
  if (bytes.size() > kPreamble && bytes.substr(kPreamble) == kDicomMark) {
    return true;
  }
  // A data set without a preamble begins with the file meta group or the identifying group, whose
  // first elements are short.
  if (bytes.size() < 12 || (bytes[0] != 2 && bytes[0] != 8) || bytes[1] != 0 || bytes[3] != 0) {
    return false;
  }
  constexpr std::string_view kFirstTypes = "UL OB UI CS LO SH AE";
  const bool is_explicit = kFirstTypes.find(bytes.substr(4, 2)) != std::string_view::npos;
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 4, sizeof length);
  constexpr std::uint32_t kLongestFirst = 256;
  return is_explicit || length <= kLongestFirst;
}

DicomBytes open_dicom(const fs::path& path, std::uint64_t max_memory) {
  try {
    DicomContents contents;
    std::uint64_t start = 0;
    return open_with_start(path, max_memory, contents, start);
  } catch (const CutOff&) {
  } catch (const InvalidElements&) {
  }
  throw bad_file(path, "has changed while it was read");
}

DicomContents read_dicom_contents(const fs::path& path, std::uint64_t max_memory) {
  DicomContents contents;
  contents.bytes = readable_file_size(path);
  try {
    std::uint64_t start = 0;
    DicomBytes bytes = open_with_start(path, max_memory, contents, start);
    Parser(bytes, contents).parse_data_set(start);
  } catch (const CutOff&) {
    contents.is_cut_off = true;
  } catch (const InvalidElements&) {
    throw bad_file(path, "is damaged: its data elements are not valid");
  }
  return contents;
}

}  // namespace isoatlas::detail::io
