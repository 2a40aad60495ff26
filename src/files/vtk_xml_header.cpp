// SPDX-License-Identifier: Apache-2.0
#include "files/vtk_xml_header.h"

#include <expat.h>

#include <algorithm>
#include <array>
#include <exception>
#include <fstream>
#include <memory>
#include <new>

#include "files/file_error.h"
#include "files/number_text.h"
#include "files/stored_data.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

// Reads elements up to <AppendedData>: what follows it need not be XML.
class ElementReader {
 public:
  explicit ElementReader(const fs::path& path)
      : path_(path), parser_(XML_ParserCreate(nullptr), XML_ParserFree) {
    if (!parser_) {
      throw std::bad_alloc();
    }
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(
        parser_.get(),
        [](void* self, const XML_Char* name, const XML_Char** attributes) {
          static_cast<ElementReader*>(self)->start(name, attributes);
        },
        [](void* self, const XML_Char*) { static_cast<ElementReader*>(self)->end(); });
  }

  void read(VtkXmlHeader& header) {
    std::ifstream file(path_, std::ios::binary);
    std::vector<char> chunk(std::size_t{1} << 16);
    while (!is_stopped_) {
      file.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
      const auto count = static_cast<int>(file.gcount());
      if (XML_Parse(parser_.get(), chunk.data(), count, count == 0 ? 1 : 0) == XML_STATUS_ERROR &&
          !is_stopped_) {
        throw bad_file(path_, "is not well-formed XML: line " +
                                  std::to_string(XML_GetCurrentLineNumber(parser_.get())) + ": " +
                                  XML_ErrorString(XML_GetErrorCode(parser_.get())));
      }
      if (count == 0) {
        break;
      }
    }
    if (error_) {
      std::rethrow_exception(error_);
    }
    if (open_.empty() && !has_root_) {
      throw bad_file(path_, "is not well-formed XML: no element was found");
    }
    while (open_.size() > 1) {  // the elements that contain <AppendedData>
      close();
    }
    header.root = open_.empty() ? std::move(root_) : std::move(open_.front().element);
    header.appended_begin = appended_begin_;
  }

 private:
  struct OpenElement {
    XmlElement element;
    std::uint64_t stretch_begin = 0;  // begin of the current run of text
  };

  // The parser is C code: no exception may pass through it.
  template <class Work>
  void guarded(Work work) noexcept {
    try {
      work();
    } catch (...) {
      error_ = std::current_exception();
      stop();
    }
  }

  void stop() {
    is_stopped_ = true;
    XML_StopParser(parser_.get(), XML_FALSE);
  }

  std::uint64_t position() const {
    return static_cast<std::uint64_t>(XML_GetCurrentByteIndex(parser_.get()));
  }
  std::uint64_t position_behind() const {
    return position() + static_cast<std::uint64_t>(XML_GetCurrentByteCount(parser_.get()));
  }

  void start(const XML_Char* name, const XML_Char** attributes) {
    guarded([&] {
      constexpr std::size_t kMostDepth = 32;
      if (open_.size() == kMostDepth) {
        throw bad_file(path_, "has XML elements in more than " + std::to_string(kMostDepth) +
                                  " levels, expected a VTK file");
      }
      if (!open_.empty()) {
        end_stretch(open_.back());
      }
      OpenElement open;
      open.element.name = name;
      for (const XML_Char** a = attributes; *a != nullptr; a += 2) {
        open.element.attributes.emplace_back(a[0], a[1]);
      }
      open.stretch_begin = position_behind();
      open_.push_back(std::move(open));
      if (open_.back().element.name == "AppendedData" && open_.size() == 2) {
        appended_begin_ = position_behind();
        stop();
      }
    });
  }

  void end() {
    guarded([&] {
      end_stretch(open_.back());
      const std::uint64_t behind = position_behind();
      if (open_.size() > 1) {
        close();
        open_.back().stretch_begin = behind;
      } else {
        root_ = std::move(open_.back().element);
        open_.clear();
        has_root_ = true;
      }
    });
  }

  void end_stretch(OpenElement& open) const {
    const std::uint64_t end = std::max(position(), open.stretch_begin);
    if (end - open.stretch_begin > open.element.text_end - open.element.text_begin) {
      open.element.text_begin = open.stretch_begin;
      open.element.text_end = end;
    }
  }

  void close() {
    XmlElement element = std::move(open_.back().element);
    open_.pop_back();
    open_.back().element.children.push_back(std::move(element));
  }

  const fs::path& path_;
  std::unique_ptr<XML_ParserStruct, void (*)(XML_Parser)> parser_;
  std::vector<OpenElement> open_;
  XmlElement root_;
  bool has_root_ = false, is_stopped_ = false;
  std::uint64_t appended_begin_ = 0;
  std::exception_ptr error_;
};

// Appended data begins after the first underscore and ends at the last </AppendedData>.
void find_appended_data(VtkXmlHeader& header) {
  constexpr std::string_view kEnd = "</AppendedData";
  constexpr std::uint64_t kMostBlanks = 4096;
  const XmlElement* element = header.root.child("AppendedData");
  if (element == nullptr) {
    return;
  }
  header.is_appended_raw = element->attribute_or("encoding", "base64") == "raw";
  std::ifstream file(header.path, std::ios::binary);
  std::string text(kMostBlanks, '\0');
  file.seekg(static_cast<std::streamoff>(header.appended_begin));
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  const std::size_t underscore = text.find_first_not_of(" \t\r\n");
  if (underscore == std::string::npos || text[underscore] != '_') {
    throw bad_file(header.path, "its appended data does not begin with '_'");
  }
  header.appended_begin += underscore + 1;

  const std::uint64_t file_bytes = readable_file_size(header.path);
  const std::uint64_t tail_begin =
      std::max(header.appended_begin, file_bytes - std::min(file_bytes, 2 * kMostBlanks));
  text.assign(static_cast<std::size_t>(file_bytes - std::min(file_bytes, tail_begin)), '\0');
  file.clear();
  file.seekg(static_cast<std::streamoff>(tail_begin));
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  const std::size_t end = text.rfind(kEnd);
  if (end == std::string::npos) {
    throw bad_file(header.path, "is cut off: its appended data does not end with </AppendedData>");
  }
  header.appended_end = tail_begin + end;
}

void read_encoding(VtkXmlHeader& header) {
  const std::string number = header.root.attribute_or("header_type", "UInt32");
  if (number != "UInt32" && number != "UInt64") {
    throw unsupported(header.path, "its header_type is '" + one_line(number, 40) +
                                       "', expected UInt32 or UInt64");
  }
  header.number_bytes = number == "UInt64" ? 8 : 4;
  const std::string order = header.root.attribute_or("byte_order", "LittleEndian");
  if (order != "LittleEndian" && order != "BigEndian") {
    throw bad_file(header.path, "its byte_order is '" + one_line(order, 40) +
                                    "', expected LittleEndian or BigEndian");
  }
  header.is_big_endian = order == "BigEndian";
  const std::string compressor = header.root.attribute_or("compressor", "");
  constexpr std::array<std::pair<std::string_view, VtkCompressor>, 4> kCompressors{
      {{"", VtkCompressor::none},
       {"vtkZLibDataCompressor", VtkCompressor::zlib},
       {"vtkLZ4DataCompressor", VtkCompressor::lz4},
       {"vtkLZMADataCompressor", VtkCompressor::lzma}}};
  const auto* const found =
      std::ranges::find(kCompressors, compressor, [](const auto& entry) { return entry.first; });
  if (found == kCompressors.end()) {
    throw unsupported(header.path, "is compressed by '" + one_line(compressor, 40) +
                                       "', expected one of vtkZLibDataCompressor, "
                                       "vtkLZ4DataCompressor, vtkLZMADataCompressor");
  }
  header.compressor = found->second;
}

}  // namespace

const std::string* XmlElement::attribute(std::string_view attribute_name) const {
  const auto found = std::ranges::find(
      attributes, attribute_name, [](const auto& entry) { return std::string_view(entry.first); });
  return found == attributes.end() ? nullptr : &found->second;
}

std::string XmlElement::attribute_or(std::string_view attribute_name,
                                     const std::string& otherwise) const {
  const std::string* const value = attribute(attribute_name);
  return value == nullptr ? otherwise : *value;
}

const XmlElement* XmlElement::child(std::string_view child_name) const {
  const auto found = std::ranges::find(children, child_name, [](const XmlElement& element) {
    return std::string_view(element.name);
  });
  return found == children.end() ? nullptr : &*found;
}

VtkXmlHeader read_vtk_xml_header(const fs::path& path) {
  VtkXmlHeader header{.path = path};
  require_ending(path, "</VTKFile>");
  ElementReader(path).read(header);
  if (header.root.name != "VTKFile") {
    throw bad_file(path, "begins with the XML element '" + one_line(header.root.name, 40) +
                             "', expected VTKFile");
  }
  find_appended_data(header);
  read_encoding(header);
  return header;
}

std::vector<double> numbers_of(const VtkXmlHeader& header, const XmlElement& element,
                               std::string_view attribute, std::size_t count) {
  const std::string* const text = element.attribute(attribute);
  std::vector<double> numbers;
  if (text == nullptr) {
    return numbers;
  }
  constexpr std::string_view kBlanks = " \t\r\n";
  for (std::size_t begin = text->find_first_not_of(kBlanks); begin != std::string::npos;) {
    const std::size_t end = std::min(text->find_first_of(kBlanks, begin), text->size());
    if (!parse_number(std::string_view(*text).substr(begin, end - begin), numbers.emplace_back())) {
      numbers.clear();
      break;
    }
    begin = text->find_first_not_of(kBlanks, end);
  }
  if (numbers.empty() || (count > 0 && numbers.size() != count)) {
    throw bad_file(header.path, "its " + std::string(attribute) + " is '" + one_line(*text, 80) +
                                    "', expected " +
                                    (count > 0 ? std::to_string(count) + " " : "") + "numbers");
  }
  return numbers;
}

}  // namespace isoatlas::detail::io
