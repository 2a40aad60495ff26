// SPDX-License-Identifier: Apache-2.0
#include "io/vtk_xml_file.h"

#include <vtkNew.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLDataParser.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
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

// Knows where the data of an array begins: in its element, or in the section after all elements.
class BlockHeaders {
 public:
  BlockHeaders(const fs::path& path, vtkXMLDataElement& root, vtkXMLDataParser& parser)
      : path_(path),
        file_(path, std::ios::binary),
        number_bytes_(attribute(root, "header_type") == "UInt64" ? 8 : 4),
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
        check_array(inner);
      }
      check_below(inner);
    }
  }

 private:
  // Compressed data starts with the number of blocks, the size of a block and the size of the last one.
  void check_array(vtkXMLDataElement& array) {
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
    if (start.size() < 2 * number_bytes_ || (number_at(start, 0) > 0 && number_at(start, number_bytes_) == 0)) {
      throw bad_file(path_, "its compressed data is damaged: a block of size zero");
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

  const fs::path& path_;
  std::ifstream file_;
  std::size_t number_bytes_;
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
  if (!attribute(*root, "compressor").empty()) {
    BlockHeaders(path, *root, *parser).check_below(*root);
  }
}

}  // namespace isoatlas::io
