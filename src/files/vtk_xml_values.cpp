// SPDX-License-Identifier: Apache-2.0
#include "files/vtk_xml_values.h"

#include <expat.h>
#include <lz4.h>
#include <lzma.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "files/file_error.h"
#include "files/stored_data.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMostBytesPerByte =
    10'000;  // LZMA, the strongest of VTK's compressors, on constant data

// Decodes base64, in which four characters stand for three bytes. The text may be several base64
// texts in sequence, each with its own padding.
class Base64Bytes final : public ByteStream {
 public:
  Base64Bytes(const fs::path& path, std::unique_ptr<ByteStream> text)
      : path_(path), text_(std::move(text)), buffer_(std::size_t{1} << 14) {}

  std::size_t read(char* to, std::size_t bytes) override {
    std::size_t made = 0;
    while (made < bytes) {
      if (first_ == last_) {
        first_ = 0;
        last_ = text_->read(buffer_.data(), buffer_.size());
        if (last_ == 0) {
          break;
        }
      }
      const auto c = static_cast<unsigned char>(buffer_[first_++]);
      const int digit = kDigits[c];
      if (digit >= 0) {
        bits_ = bits_ << 6U | static_cast<unsigned>(digit);
        bit_count_ += 6;
        if (bit_count_ >= 8) {
          bit_count_ -= 8;
          to[made++] = static_cast<char>(bits_ >> bit_count_ & 0xFFU);
        }
      } else if (c == '=') {
        bit_count_ = 0;
      } else if (digit == kOther) {
        throw bad_file(path_, "is cut off or damaged: an array's base64 text ends too early");
      }
    }
    return made;
  }

 private:
  static constexpr int kBlank = -1, kOther = -2;
  static constexpr std::array<int, 256> kDigits = [] {
    std::array<int, 256> digits{};
    digits.fill(kOther);
    int value = 0;
    for (const char c :
         std::string_view("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/")) {
      digits[static_cast<unsigned char>(c)] = value++;
    }
    for (const char c : std::string_view(" \t\r\n="))
      digits[static_cast<unsigned char>(c)] = kBlank;
    return digits;
  }();

  fs::path path_;
  std::unique_ptr<ByteStream> text_;
  std::vector<char> buffer_;
  std::size_t first_ = 0, last_ = 0;
  unsigned bits_ = 0;
  unsigned bit_count_ = 0;
};

// Decompresses into exactly `to_bytes` bytes; false if the result has another size or `from` is
// damaged.
bool decompress(VtkCompressor compressor, const std::vector<char>& from, char* to,
                std::size_t to_bytes) {
  const auto* const from_bytes = reinterpret_cast<const std::uint8_t*>(from.data());
  if (compressor == VtkCompressor::zlib) {
    uLongf made = static_cast<uLongf>(to_bytes);
    return uncompress(reinterpret_cast<Bytef*>(to), &made, from_bytes,
                      static_cast<uLong>(from.size())) == Z_OK &&
           made == to_bytes;
  }
  if (compressor == VtkCompressor::lz4) {
    constexpr std::size_t kMost = std::numeric_limits<int>::max();
    return from.size() <= kMost && to_bytes <= kMost &&
           LZ4_decompress_safe(from.data(), to, static_cast<int>(from.size()),
                               static_cast<int>(to_bytes)) == static_cast<int>(to_bytes);
  }
  std::uint64_t memory = std::uint64_t{1} << 28;  // more than the strongest LZMA preset needs
  std::size_t used = 0, made = 0;
  auto* const to_begin = reinterpret_cast<std::uint8_t*>(to);
  return lzma_stream_buffer_decode(&memory, 0, nullptr, from_bytes, &used, from.size(), to_begin,
                                   &made, to_bytes) == LZMA_OK &&
         made == to_bytes;
}

struct Blocks {
  std::uint64_t count = 0, bytes = 0,
                last_bytes =
                    0;  // decompressed; last_bytes 0: the last block has the size of the others
  std::vector<std::uint64_t> packed_bytes = {};

  std::uint64_t total_bytes() const {
    return count * bytes - (count > 0 && last_bytes > 0 ? bytes - last_bytes : 0);
  }
};

class BlockBytes final : public ByteStream {
 public:
  BlockBytes(const fs::path& path, std::unique_ptr<ByteStream> packed, VtkCompressor compressor,
             Blocks blocks)
      : path_(path),
        packed_(std::move(packed)),
        compressor_(compressor),
        blocks_(std::move(blocks)) {}

  std::size_t read(char* to, std::size_t bytes) override {
    std::size_t made = 0;
    while (made < bytes) {
      if (used_ == block_.size()) {
        if (next_ == blocks_.count) {
          break;
        }
        const std::size_t size = next_block_bytes();
        if (bytes - made >= size) {
          unpack(to + made, size);
          made += size;
          continue;
        }
        block_.resize(size);
        used_ = 0;
        unpack(block_.data(), size);
      }
      const std::size_t count = std::min(bytes - made, block_.size() - used_);
      std::copy_n(block_.data() + used_, count, to + made);
      used_ += count;
      made += count;
    }
    return made;
  }

 private:
  std::size_t next_block_bytes() const {
    const bool is_last = next_ + 1 == blocks_.count;
    return static_cast<std::size_t>(is_last && blocks_.last_bytes > 0 ? blocks_.last_bytes
                                                                      : blocks_.bytes);
  }

  void unpack(char* to, std::size_t bytes) {
    packed_block_.resize(
        static_cast<std::size_t>(blocks_.packed_bytes[static_cast<std::size_t>(next_)]));
    if (packed_->read(packed_block_.data(), packed_block_.size()) != packed_block_.size() ||
        !decompress(compressor_, packed_block_, to, bytes)) {
      throw bad_file(path_, "its compressed data is damaged in block " + std::to_string(next_) +
                                " of " + std::to_string(blocks_.count));
    }
    ++next_;
  }

  fs::path path_;
  std::unique_ptr<ByteStream> packed_;
  VtkCompressor compressor_;
  Blocks blocks_;
  std::uint64_t next_ = 0;
  std::vector<char> packed_block_, block_;
  std::size_t used_ = 0;  // bytes of the decompressed block that were returned
};

// Finds one array in the file, checks its size and opens it.
class ArrayOpener {
 public:
  ArrayOpener(const VtkXmlHeader& header, const XmlElement& array, VtkType type,
              std::uint64_t count)
      : header_(header),
        type_(type),
        count_(count),
        name_("its array '" + one_line(array.attribute_or("Name", ""), 80) + "'") {
    const std::string* const offset = array.attribute("offset");
    is_appended_ =
        array.attribute_or("format", offset == nullptr ? "ascii" : "appended") == "appended";
    is_text_ = !is_appended_ && array.attribute_or("format", "ascii") != "binary";
    begin_ = array.text_begin;
    end_ = array.text_end;
    if (is_appended_) {
      locate_appended(offset == nullptr ? "" : *offset);
    }
  }

  std::unique_ptr<VtkValues> open() {
    const std::uint64_t stored = end_ - begin_;
    if (is_text_) {
      require_possible_bytes(header_.path, count_, stored, 1);
      require_no_more_numbers();
      return text_values(header_.path, FileText(header_.path, begin_, end_), type_);
    }
    const std::uint64_t bytes = type_.stored_bytes(count_);
    require_possible_bytes(header_.path, bytes, stored,
                           header_.compressor == VtkCompressor::none ? 1 : kMostBytesPerByte);
    std::unique_ptr<ByteStream> stream = encoded_bytes();
    if (header_.compressor == VtkCompressor::none) {
      require_bytes(next_number(*stream), bytes);
      require_stored(bytes);
    } else {
      Blocks blocks = read_block_table(*stream);
      require_bytes(blocks.total_bytes(), bytes);
      stream = std::make_unique<BlockBytes>(header_.path, std::move(stream), header_.compressor,
                                            std::move(blocks));
    }
    return binary_values(header_.path, std::move(stream), type_, header_.is_big_endian);
  }

  // VTK stores strings in sequence, each with a terminating zero; in text files each character is
  // written as its number.
  std::string first_string() {
    if (is_text_) {
      return first_string_in_text();
    }
    std::unique_ptr<ByteStream> stream = encoded_bytes();
    const std::uint64_t stored = end_ - begin_;
    std::uint64_t bytes = 0;
    if (header_.compressor == VtkCompressor::none) {
      bytes = next_number(*stream);
      require_stored(bytes);
    } else {
      Blocks blocks = read_block_table(*stream);
      bytes = blocks.total_bytes();
      require_possible_bytes(header_.path, bytes, stored, kMostBytesPerByte);
      stream = std::make_unique<BlockBytes>(header_.path, std::move(stream), header_.compressor,
                                            std::move(blocks));
    }
    require_string_length(bytes);
    std::string text(static_cast<std::size_t>(bytes), '\0');
    if (stream->read(text.data(), text.size()) != text.size()) {
      throw bad_file(header_.path, "is cut off: " + name_ + " ends too early");
    }
    return text.substr(0, text.find('\0'));
  }

 private:
  std::unique_ptr<ByteStream> encoded_bytes() const {
    std::unique_ptr<ByteStream> stream = file_bytes(header_.path, begin_, end_);
    const bool is_raw = is_appended_ && header_.is_appended_raw;
    return is_raw ? std::move(stream)
                  : std::make_unique<Base64Bytes>(header_.path, std::move(stream));
  }

  void require_string_length(std::uint64_t bytes) const {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 26;
    if (bytes > kMost) {
      throw unsupported(header_.path, name_ + " has " + std::to_string(bytes) +
                                          " bytes of text, expected at most " +
                                          std::to_string(kMost));
    }
  }

  std::string first_string_in_text() const {
    FileText text(header_.path, begin_, end_);
    std::string characters;
    for (std::string_view word = text.word(); !word.empty(); word = text.word()) {
      unsigned code = 0;
      const auto [word_end, error] = std::from_chars(word.data(), word.data() + word.size(), code);
      if (error != std::errc{} || word_end != word.data() + word.size() || code > 0xFF) {
        throw bad_file(header_.path, name_ + " has '" + one_line(word, 40) +
                                         "', expected a character code from 0 to 255");
      }
      if (code == 0) {
        break;
      }
      characters += static_cast<char>(code);
      require_string_length(characters.size());
    }
    return characters;
  }

  void locate_appended(const std::string& offset_text) {
    std::uint64_t offset = 0;
    const char* const text_end = offset_text.data() + offset_text.size();
    const auto [end, error] = std::from_chars(offset_text.data(), text_end, offset);
    if (error != std::errc{} || end != text_end) {
      throw bad_file(header_.path, name_ + " has the offset '" + one_line(offset_text, 40) +
                                       "', expected a number of bytes");
    }
    if (offset >= header_.appended_end - header_.appended_begin) {
      throw bad_file(header_.path,
                     "is cut off or damaged: " + name_ + " begins at " + std::to_string(offset) +
                         " in appended data of " +
                         std::to_string(header_.appended_end - header_.appended_begin) + " bytes");
    }
    begin_ = header_.appended_begin + offset;
    end_ = header_.appended_end;
  }

  // With more numbers than samples, the extent does not belong to the values, and each row would
  // begin in the wrong place.
  void require_no_more_numbers() const {
    FileText text(header_.path, begin_, end_);
    std::uint64_t found = 0;
    while (found <= count_ && !text.word().empty()) {
      ++found;
    }
    if (found != count_) {
      throw bad_file(header_.path, "is cut off or damaged: " + name_ + " has " +
                                       (found > count_ ? "more" : std::to_string(found)) +
                                       " numbers, expected " + std::to_string(count_));
    }
  }

  std::uint64_t next_number(ByteStream& stream) const {
    std::array<char, 8> bytes{};
    if (stream.read(bytes.data(), header_.number_bytes) != header_.number_bytes) {
      throw bad_file(header_.path, "is cut off: " + name_ + " has no data");
    }
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < header_.number_bytes; ++i) {
      number = number << 8U | static_cast<unsigned char>(
                                  bytes[header_.is_big_endian ? i : header_.number_bytes - 1 - i]);
    }
    return number;
  }

  void require_bytes(std::uint64_t found, std::uint64_t bytes) const {
    if (found != bytes) {
      throw bad_file(header_.path, "is cut off or damaged: " + name_ + " has " +
                                       std::to_string(found) + " bytes of values, expected " +
                                       std::to_string(bytes) + " (" + std::to_string(count_) +
                                       " of " + std::string(type_.name()) + ")");
    }
  }

  // Throws unless the array's part of the file can hold `bytes` bytes. Called before memory is
  // allocated.
  void require_stored(std::uint64_t bytes) const {
    const std::uint64_t in_file = end_ - begin_;
    const bool is_base64 = !is_appended_ || !header_.is_appended_raw;
    const std::uint64_t most =
        is_base64 ? in_file / 4 * 3 + 3
                  : in_file - std::min<std::uint64_t>(in_file, header_.number_bytes);
    require_stored_bytes(header_.path, bytes, most);
  }

  // Reads the number of blocks, the size of a block, the size of the last block if it is smaller
  // (else 0), and the compressed size of each block.
  Blocks read_block_table(ByteStream& stream) const {
    Blocks blocks;
    blocks.count = next_number(stream);
    blocks.bytes = next_number(stream);
    blocks.last_bytes = next_number(stream);
    const std::uint64_t in_file = end_ - begin_;
    bool is_possible = blocks.count <= in_file / header_.number_bytes &&
                       blocks.last_bytes <= blocks.bytes &&
                       (blocks.count > 0 ? blocks.bytes > 0 : blocks.last_bytes == 0) &&
                       blocks.bytes <= std::numeric_limits<std::uint64_t>::max() / 2 /
                                           std::max<std::uint64_t>(blocks.count, 1);
    std::uint64_t packed_bytes = 0;
    for (std::uint64_t i = 0; is_possible && i < blocks.count; ++i) {
      blocks.packed_bytes.push_back(next_number(stream));
      is_possible = blocks.packed_bytes.back() <= in_file;
      packed_bytes += blocks.packed_bytes.back();
      is_possible = is_possible && packed_bytes <= in_file;
    }
    if (!is_possible) {
      throw bad_file(header_.path,
                     "its compressed data is damaged: " + std::to_string(blocks.count) +
                         " blocks of " + std::to_string(blocks.bytes) + " bytes");
    }
    return blocks;
  }

  const VtkXmlHeader& header_;
  VtkType type_;
  std::uint64_t count_;
  std::string name_;
  bool is_appended_ = false, is_text_ = false;
  std::uint64_t begin_ = 0, end_ = 0;  // in the file
};

}  // namespace

std::optional<VtkType> vtk_xml_type(const VtkXmlHeader& header, const XmlElement& array) {
  constexpr std::array<std::pair<std::string_view, VtkType>, 11> kTypes{
      {{"Int8", {SampleType::int8}},
       {"UInt8", {SampleType::uint8}},
       {"Int16", {SampleType::int16}},
       {"UInt16", {SampleType::uint16}},
       {"Int32", {SampleType::int32}},
       {"UInt32", {SampleType::uint32}},
       {"Int64", {SampleType::int64}},
       {"UInt64", {SampleType::uint64}},
       {"Float32", {SampleType::float32}},
       {"Float64", {SampleType::float64}},
       {"Bit", {SampleType::uint8, true}}}};
  const std::string type = array.attribute_or("type", "");
  if (type == "String") {
    return std::nullopt;
  }
  const auto* const found =
      std::ranges::find(kTypes, type, [](const auto& entry) { return entry.first; });
  if (found == kTypes.end()) {
    throw bad_file(header.path,
                   "has an array of unknown data type '" + one_line(type, 40) +
                       "', expected one of Int8 to UInt64, Float32, Float64, Bit or String");
  }
  return found->second;
}

std::unique_ptr<VtkValues> open_xml_values(const VtkXmlHeader& header, const XmlElement& array,
                                           VtkType type, std::uint64_t count) {
  return ArrayOpener(header, array, type, count).open();
}

std::string first_xml_string(const VtkXmlHeader& header, const XmlElement& array) {
  return ArrayOpener(header, array, {}, 0).first_string();
}

std::string vtk_xml_reader_name(const VtkXmlHeader& header) {
  std::string expat = XML_ExpatVersion();
  std::ranges::replace(expat, '_', ' ');
  switch (header.compressor) {
    case VtkCompressor::zlib:
      return "isoatlas, " + expat + ", zlib " + zlibVersion();
    case VtkCompressor::lz4:
      return "isoatlas, " + expat + ", lz4 " + LZ4_versionString();
    case VtkCompressor::lzma:
      return "isoatlas, " + expat + ", liblzma " + lzma_version_string();
    case VtkCompressor::none:
      break;
  }
  return "isoatlas, " + expat;
}

}  // namespace isoatlas::detail::io
