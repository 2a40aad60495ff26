// SPDX-License-Identifier: Apache-2.0
// The values of a <DataArray>: text, base64 or raw, compressed or not.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "files/vtk_values.h"
#include "files/vtk_xml_header.h"

namespace isoatlas::detail::io {

/// The type of an array; none: it holds strings.
/// @throws Error(bad_file) if there is no such type
std::optional<VtkType> vtk_xml_type(const VtkXmlHeader& header, const XmlElement& array);

/// Opens the values, after checking as far as that goes without reading them that there are exactly
/// `count`.
/// @throws Error(bad_file) if there are not
std::unique_ptr<VtkValues> open_xml_values(const VtkXmlHeader& header, const XmlElement& array,
                                           VtkType type, std::uint64_t count);

/// The first of an array's strings; empty if it has none. Longer ones than 64 MiB are refused.
/// @throws Error(bad_file) if the array is damaged
std::string first_xml_string(const VtkXmlHeader& header, const XmlElement& array);

/// The libraries that read such a file, with their versions.
std::string vtk_xml_reader_name(const VtkXmlHeader& header);

}  // namespace isoatlas::detail::io
