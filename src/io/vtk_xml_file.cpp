// SPDX-License-Identifier: Apache-2.0
#include "io/vtk_xml_file.h"

#include <vtkNew.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLDataParser.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

#include "io/file_error.h"
#include "io/stored_data.h"

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
    constexpr std::array<std::string_view, 12> kTypes{"Int8",  "Int16",  "Int32",  "Int64",   "UInt8",   "UInt16",
                                                      "UInt32", "UInt64", "Float32", "Float64", "String", "Bit"};
    const std::string type = attribute(array, "type");
    if (std::ranges::find(kTypes, type) == kTypes.end()) {
      throw bad_file(path_, "has an array of unknown data type '" + one_line(type, 40) + "'");
    }
  }

  // Compressed data starts with the number of blocks, the size of a block and the size of the last one.
  void check_blocks(vtkXMLDataElement& array) {
    const std::string format = attribute(array, "format");
    std::string start;
    if (format == "appended") {
      unsigned long long offset = 0;
      if (array.GetScalarAttribute("offset", offset) == 0) {
        return;
      }
      const std::string text = bytes_at(appended_position_ + static_cast<std::int64_t>(offset));
      start = is_appended_base64_ ? decode_base64(text, 2 * number_bytes_) : text;
    } else if (format == "binary") {
      const std::string text = bytes_at(array.GetXMLByteIndex());
      start = decode_base64(std::string_view(text).substr(std::min(text.find('>'), text.size() - 1) + 1), 2 * number_bytes_);
    } else {
      return;
    }
    if (start.size() < 2 * number_bytes_) {
      throw bad_file(path_, "is cut off: an array has no data");
    }
    const std::uint64_t blocks = number_at(start, 0);
    const std::uint64_t block_bytes = number_at(start, number_bytes_);
    if (blocks == 0) {
      return;  // an empty array
    }
    // Each block has an entry in a table of sizes, and VTK allocates a block and the table before it reads on.
    if (block_bytes == 0 || blocks > file_bytes_ / number_bytes_ || block_bytes / kMostBytesPerByte > file_bytes_) {
      throw bad_file(path_, "its compressed data is damaged: " + std::to_string(blocks) + " blocks of " +
                                std::to_string(block_bytes) + " bytes");
    }
  }

  std::string bytes_at(std::int64_t position) {
    constexpr std::size_t kMost = 4096;  // an element's attributes and the start of its data
    std::string bytes(kMost, '\0');
    file_.clear();
    file_.seekg(position);
    file_.read(bytes.data(), kMost);
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(file_.gcount(), 0)));
    return bytes.empty() ? std::string(1, ' ') : bytes;
  }

  std::uint64_t number_at(const std::string& bytes, std::size_t position) const {
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < number_bytes_; ++i) {
      const std::size_t place = is_big_endian_ ? i : number_bytes_ - 1 - i;
      number = number << 8U | static_cast<unsigned char>(bytes[position + place]);
    }
    return number;
  }

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
