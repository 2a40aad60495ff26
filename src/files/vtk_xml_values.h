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

/// The type of an array; nothing if the array holds strings.
/// @throws Error(bad_file) for an unknown type
std::optional<VtkType> vtk_xml_type(const VtkXmlHeader& header, const XmlElement& array);

/// Opens the values. Checks first that there are exactly `count`, as far as that is possible
/// without reading them.
/// @throws Error(bad_file) if there are more or fewer
std::unique_ptr<VtkValues> open_xml_values(const VtkXmlHeader& header, const XmlElement& array,
                                           VtkType type, std::uint64_t count);

/// The first string of an array; empty if it has none. Strings longer than 64 MiB are refused.
/// @throws Error(bad_file) if the array is damaged
std::string first_xml_string(const VtkXmlHeader& header, const XmlElement& array);

/// The names and versions of the libraries that read such a file.
std::string vtk_xml_reader_name(const VtkXmlHeader& header);

}  // namespace isoatlas::detail::io
