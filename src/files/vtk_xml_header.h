// SPDX-License-Identifier: Apache-2.0
// The elements of a VTK XML file and where their text is. Values of arrays are not in memory,
// however many there are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace isoatlas::detail::io {

struct XmlElement {
  std::string name = {};
  std::vector<std::pair<std::string, std::string>> attributes = {};
  std::vector<XmlElement> children = {};
  std::uint64_t text_begin = 0,
                text_end = 0;  ///< in the file: the longest stretch of text that is not in a child

  const std::string* attribute(std::string_view name) const;  ///< null: there is none
  std::string attribute_or(std::string_view name, const std::string& otherwise) const;
  const XmlElement* child(std::string_view name) const;  ///< the first one; null: there is none
};

enum class VtkCompressor { none, zlib, lz4, lzma };

struct VtkXmlHeader {
  std::filesystem::path path;
  XmlElement root = {};  ///< <VTKFile>
  std::uint64_t appended_begin = 0,
                appended_end = 0;  ///< of the appended data in the file; both 0: there is none
  bool is_appended_raw = false;    ///< else base64
  std::size_t number_bytes = 4;    ///< of a number before an array's values
  bool is_big_endian = false;
  VtkCompressor compressor = VtkCompressor::none;
};

/// @throws Error(bad_file)     cut off or not well-formed
/// @throws Error(unsupported)  an unknown compressor or type of number
VtkXmlHeader read_vtk_xml_header(const std::filesystem::path& path);

/// The numbers in an attribute, `count` of them, or any number of them if that is 0; none where
/// there is no such attribute.
/// @throws Error(bad_file) if they are others
std::vector<double> numbers_of(const VtkXmlHeader& header, const XmlElement& element,
                               std::string_view attribute, std::size_t count);

}  // namespace isoatlas::detail::io
