// SPDX-License-Identifier: Apache-2.0
// The elements of a VTK XML file and the places of their text in the file. The values of arrays are
// not read into memory.
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
                text_end = 0;  ///< in the file: the longest run of text outside the children

  const std::string* attribute(std::string_view name) const;  ///< null if it is missing
  std::string attribute_or(std::string_view name, const std::string& otherwise) const;
  const XmlElement* child(std::string_view name) const;  ///< the first one; null if it is missing
};

enum class VtkCompressor { none, zlib, lz4, lzma };

struct VtkXmlHeader {
  std::filesystem::path path;
  XmlElement root = {};  ///< <VTKFile>
  std::uint64_t appended_begin = 0,
                appended_end =
                    0;  ///< range of the appended data in the file; both 0 without appended data
  bool is_appended_raw = false;  ///< otherwise base64
  std::size_t number_bytes = 4;  ///< size of each number in the header of an array
  bool is_big_endian = false;
  VtkCompressor compressor = VtkCompressor::none;
};

/// @throws Error(bad_file)     if the file is cut off or not well-formed
/// @throws Error(unsupported)  for an unknown compressor or type of number
VtkXmlHeader read_vtk_xml_header(const std::filesystem::path& path);

/// The numbers in an attribute; empty if the attribute is missing. There must be `count` of them; 0
/// accepts any number of them.
/// @throws Error(bad_file) if the attribute holds anything else
std::vector<double> numbers_of(const VtkXmlHeader& header, const XmlElement& element,
                               std::string_view attribute, std::size_t count);

}  // namespace isoatlas::detail::io
