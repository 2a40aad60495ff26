// SPDX-License-Identifier: Apache-2.0
#include "files/vtk_xml_file.h"

#include <vtkNew.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLDataParser.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

#include "files/file_error.h"
#include "files/stored_data.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

namespace {

std::string attribute(vtkXMLDataElement& element, const char* name) {
  const char* value = element.GetAttribute(name);
  return value == nullptr ? "" : value;
}

// The first bytes of base64 text, blanks skipped; fewer where it ends.
std::string decode_base64(std::string_view text, std::size_t bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string decoded;
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) {
      if (c == ' ' || c == '\t' || c == '\r' || c == '\n') {
        continue;
      }
      break;
    }
    bits = bits << 6U | static_cast<std::uint32_t>(digit);
    bit_count += 6;
    if (bit_count >= 8) {
      bit_count -= 8;
      decoded += static_cast<char>(bits >> static_cast<unsigned>(bit_count) & 0xFFU);
    }
    if (decoded.size() == bytes) {
      break;
    }
  }
  return decoded;
}

// Goes over all arrays. Their data begins in their element, or in a section after all elements.
class ArrayCheck {
 public:
  ArrayCheck(const fs::path& path, vtkXMLDataElement& root, vtkXMLDataParser& parser)
      : path_(path),
        file_(path, std::ios::binary),
        file_bytes_(readable_file_size(path)),
        number_bytes_(attribute(root, "header_type") == "UInt64" ? 8 : 4),
        is_compressed_(!attribute(root, "compressor").empty()),
        is_big_endian_(attribute(root, "byte_order") == "BigEndian"),
        appended_position_(parser.GetAppendedDataPosition()) {
    for (int i = 0; i < root.GetNumberOfNestedElements(); ++i) {
      vtkXMLDataElement& element = *root.GetNestedElement(i);
      if (std::string_view(element.GetName()) == "AppendedData") {
        is_appended_base64_ = attribute(element, "encoding") != "raw";
      }
    }
  }

  void check_below(vtkXMLDataElement& element) {
    for (int i = 0; i < element.GetNumberOfNestedElements(); ++i) {
      vtkXMLDataElement& inner = *element.GetNestedElement(i);
      if (std::string_view(inner.GetName()).ends_with("Array")) {
        check_type(inner);
        if (is_compressed_) {
          check_blocks(inner);
        }
      }
      check_below(inner);
    }
  }

 private:
  void check_type(vtkXMLDataElement& array) {
    constexpr std::array<std::string_view, 12> kTypes{"Int8",   "Int16",  "Int32",   "Int64",   "UInt8",  "UInt16",
                                                      "UInt32", "UInt64", "Float32", "Float64", "String", "Bit"};
    const std::string type = attribute(array, "type");
    if (std::ranges::find(kTypes, type) == kTypes.end()) {
      throw bad_file(path_, "has an array of unknown data type '" + one_line(type, 40) + "'");
    }
  }

  // Compressed data starts with the number of blocks, the size of a block, the size of the last one if it is smaller,
  // and a table of the compressed sizes.
  void check_blocks(vtkXMLDataElement& array) {
    const std::string start = data_of(array, 3 * number_bytes_);
    if (start.empty()) {
      return;  // an array as text
    }
    if (start.size() < 3 * number_bytes_) {
      throw bad_file(path_, "is cut off: an array has no data");
    }
    const std::uint64_t blocks = number_at(start, 0);
    const std::uint64_t block_bytes = number_at(start, number_bytes_);
    const std::uint64_t last_block_bytes = number_at(start, 2 * number_bytes_);
    bool is_possible = block_bytes / kMostBytesPerByte <= file_bytes_ && last_block_bytes <= block_bytes &&
                       blocks <= file_bytes_ / number_bytes_ && (blocks > 0 ? block_bytes > 0 : last_block_bytes == 0);
    if (is_possible) {
      const std::size_t table_bytes = static_cast<std::size_t>(3 + blocks) * number_bytes_;
      const std::string table = data_of(array, table_bytes);
      is_possible = table.size() == table_bytes;
      for (std::size_t entry = 3 * number_bytes_; is_possible && entry < table_bytes; entry += number_bytes_) {
        is_possible = number_at(table, entry) <= file_bytes_;
      }
    }
    if (!is_possible) {
      throw bad_file(path_,
                     "its compressed data is damaged: " + std::to_string(blocks) + " blocks of " + std::to_string(block_bytes) + " bytes");
    }
  }

  // The first bytes of an array's data; fewer where the file ends, none if the array is text.
  std::string data_of(vtkXMLDataElement& array, std::size_t bytes) {
    const std::string format = attribute(array, "format");
    const std::size_t base64_bytes = bytes * 4 / 3 + 4 + kMostBlanks;
    if (format == "appended") {
      unsigned long long offset = 0;
      array.GetScalarAttribute("offset", offset);
      const std::int64_t position = appended_position_ + static_cast<std::int64_t>(std::min<std::uint64_t>(offset, file_bytes_));
      return is_appended_base64_ ? decode_base64(bytes_at(position, base64_bytes), bytes) : bytes_at(position, bytes);
    }
    if (format == "binary") {
      const std::string element = bytes_at(array.GetXMLByteIndex(), kMostAttributeBytes + base64_bytes);
      const std::size_t tag_end = element.find('>');
      return tag_end == std::string::npos ? "" : decode_base64(std::string_view(element).substr(tag_end + 1), bytes);
    }
    return "";
  }

  std::string bytes_at(std::int64_t position, std::size_t count) {
    std::string bytes(count, '\0');
    file_.clear();
    file_.seekg(position);
    file_.read(bytes.data(), static_cast<std::streamsize>(count));
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(file_.gcount(), 0)));
    return bytes;
  }

  std::uint64_t number_at(const std::string& bytes, std::size_t position) const {
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < number_bytes_; ++i) {
      const std::size_t place = is_big_endian_ ? i : number_bytes_ - 1 - i;
      number = number << 8U | static_cast<unsigned char>(bytes[position + place]);
    }
    return number;
  }

  static constexpr std::size_t kMostBlanks = 512;             // before base64 data
  static constexpr std::size_t kMostAttributeBytes = 4096;    // of an element
  static constexpr std::uint64_t kMostBytesPerByte = 10'000;  // LZMA, the strongest of VTK's compressors

  const fs::path& path_;
  std::ifstream file_;
  std::uint64_t file_bytes_;
  std::size_t number_bytes_;
  bool is_compressed_;
  bool is_big_endian_;
  std::int64_t appended_position_;
  bool is_appended_base64_ = true;
};

}  // namespace

void require_readable_vtk_xml(const fs::path& path) {
  require_ending(path, "</VTKFile>");
  std::ifstream stream(path, std::ios::binary);
  vtkNew<vtkXMLDataParser> parser;
  parser->SetStream(&stream);
  vtkXMLDataElement* root = parser->Parse() != 0 ? parser->GetRootElement() : nullptr;
  if (root == nullptr) {
    throw bad_file(path, "is not well-formed XML");
  }
  ArrayCheck(path, *root, *parser).check_below(*root);
}

}  // namespace isoatlas::io
