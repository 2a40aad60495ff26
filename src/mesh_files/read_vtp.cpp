// SPDX-License-Identifier: Apache-2.0
// VTK's XML poly data. VTK's own reader returns uninitialised memory where values are missing and
// allocates any size that a damaged file states. So this reader is used; it reads the arrays that a
// mesh needs: points, polygons and strips.
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "field/sample_type.h"
#include "files/file_error.h"
#include "files/stored_data.h"
#include "files/vtk_xml_values.h"
#include "mesh_files/formats.h"
#include "mesh_files/polygons.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

VtkXmlHeader read_poly_data_header(const fs::path& path) {
  constexpr std::size_t kBeginning = 1024;  // bytes; only a comment can precede the element
  if (first_bytes(path, kBeginning).find("<VTKFile") == std::string::npos) {
    throw bad_file(path, "is not a VTK XML poly data file");
  }
  VtkXmlHeader header = read_vtk_xml_header(path);
  const std::string type = header.root.attribute_or("type", "");
  if (type != "PolyData" || header.root.child("PolyData") == nullptr) {
    throw bad_file(path, "is not a VTK XML poly data file: it holds '" + one_line(type, 40) + "'");
  }
  return header;
}

std::uint64_t count_of(const VtkXmlHeader& header, const XmlElement& element, std::string_view name,
                       std::uint64_t otherwise) {
  const std::vector<double> numbers =
      numbers_of(header, element, name, element.attribute(name) == nullptr ? 0 : 1);
  if (numbers.empty()) {
    return otherwise;
  }
  const double count = numbers.front();
  constexpr double kMost = 1e15;  // integers up to here are exact as double
  if (!(count >= 0 && count <= kMost) ||
      count != static_cast<double>(static_cast<std::uint64_t>(count))) {
    throw bad_file(header.path, "its " + std::string(name) + " is '" +
                                    one_line(*element.attribute(name), 40) + "', expected a count");
  }
  return static_cast<std::uint64_t>(count);
}

const XmlElement* named_array(const XmlElement& element, std::string_view name) {
  const auto found = std::ranges::find_if(element.children, [&](const XmlElement& child) {
    return child.name == "DataArray" && child.attribute_or("Name", "") == name;
  });
  return found == element.children.end() ? nullptr : &*found;
}

/// Calls `use` with each value, in its stored type. Memory grows with the values read, not with the
/// number that the file states.
template <class Use>
void for_each_value(const VtkXmlHeader& header, const XmlElement& array, std::uint64_t count,
                    Use use) {
  const std::optional<VtkType> type = vtk_xml_type(header, array);
  if (!type) {
    throw bad_file(header.path, "has an array of strings where numbers are expected");
  }
  const std::unique_ptr<VtkValues> values = open_xml_values(header, array, *type, count);
  constexpr std::uint64_t kChunk = 1 << 14;
  visit_sample_type(type->sample, [&](auto* sample) {
    using T = std::remove_const_t<std::remove_pointer_t<decltype(sample)>>;
    std::vector<T> chunk(static_cast<std::size_t>(std::min(count, kChunk)));
    for (std::uint64_t done = 0; done < count;) {
      const std::uint64_t now = std::min(count - done, kChunk);
      values->read(chunk.data(), now);
      for (std::uint64_t i = 0; i < now; ++i) {
        use(chunk[static_cast<std::size_t>(i)]);
      }
      done += now;
    }
  });
}

std::vector<std::int64_t> integers(const VtkXmlHeader& header, const XmlElement& array,
                                   std::uint64_t count) {
  std::vector<std::int64_t> all;
  for_each_value(header, array, count, [&](auto value) {
    if constexpr (std::is_integral_v<decltype(value)>) {
      all.push_back(std::in_range<std::int64_t>(value) ? static_cast<std::int64_t>(value) : -1);
    } else {
      throw bad_file(header.path, "its vertex numbers are " + array.attribute_or("type", "") +
                                      ", expected integers");
    }
  });
  return all;
}

void append_points(TriangleMesh& mesh, const VtkXmlHeader& header, const XmlElement& piece,
                   std::uint64_t count) {
  const XmlElement* const points = piece.child("Points");
  const XmlElement* const array = points == nullptr ? nullptr : points->child("DataArray");
  if (count == 0) {
    return;
  }
  if (array == nullptr) {
    throw bad_file(header.path, "has no array of points");
  }
  if (const std::uint64_t components = count_of(header, *array, "NumberOfComponents", 1);
      components != 3) {
    throw bad_file(header.path,
                   "has points of " + std::to_string(components) + " coordinates, expected 3");
  }
  std::array<double, 3> point{};
  std::size_t coordinate = 0;
  for_each_value(header, *array, 3 * count, [&](auto value) {
    point[coordinate++] = static_cast<double>(value);
    if (coordinate == point.size()) {
      mesh.positions.push_back({point[0], point[1], point[2]});
      coordinate = 0;
    }
  });
}

// Every second triangle of a strip has the opposite orientation.
void append_strip(TriangleMesh& mesh, const std::vector<std::uint32_t>& corners) {
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const bool is_even = i % 2 == 0;
    mesh.triangles.push_back(
        {corners[i - 2], corners[is_even ? i - 1 : i], corners[is_even ? i : i - 1]});
  }
}

/// Cells are stored in two arrays: the points of all cells in sequence, and the position where each
/// cell's points end.
template <class AppendCell>
void append_cells(const VtkXmlHeader& header, const XmlElement& piece, const char* kind,
                  std::uint64_t first_point, AppendCell append_cell) {
  const std::uint64_t count = count_of(header, piece, std::string("NumberOf") + kind, 0);
  if (count == 0) {
    return;
  }
  const XmlElement* const cells = piece.child(kind);
  const XmlElement* const connectivity =
      cells == nullptr ? nullptr : named_array(*cells, "connectivity");
  const XmlElement* const offsets = cells == nullptr ? nullptr : named_array(*cells, "offsets");
  if (connectivity == nullptr || offsets == nullptr) {
    throw bad_file(header.path,
                   "has no arrays 'connectivity' and 'offsets' of its " + std::string(kind));
  }
  const std::vector<std::int64_t> ends = integers(header, *offsets, count);
  if (ends.front() < 0 || !std::ranges::is_sorted(ends)) {
    throw bad_file(header.path, "its list of polygons is damaged: the offsets of its " +
                                    std::string(kind) + " decrease");
  }
  const auto points = integers(header, *connectivity, static_cast<std::uint64_t>(ends.back()));
  std::vector<std::uint32_t> corners;
  std::size_t i = 0;
  for (const std::int64_t end : ends) {
    corners.clear();
    for (; i < static_cast<std::size_t>(end); ++i) {
      const bool is_possible = points[i] >= 0 && points[i] < std::int64_t{kIndexOutOfRange};
      corners.push_back(
          vertex_index(is_possible ? points[i] + static_cast<std::int64_t>(first_point) : -1));
    }
    append_cell(corners);
  }
}

void append_distances(std::vector<float>& distance, const VtkXmlHeader& header,
                      const XmlElement& piece, std::uint64_t count) {
  const XmlElement* const data = piece.child("PointData");
  const XmlElement* const array = data == nullptr ? nullptr : named_array(*data, kVtpDistance);
  if (array != nullptr && count_of(header, *array, "NumberOfComponents", 1) == 1) {
    for_each_value(header, *array, count,
                   [&](auto value) { distance.push_back(static_cast<float>(value)); });
  }
}

std::map<std::string, std::string> text_fields(const VtkXmlHeader& header) {
  std::map<std::string, std::string> fields;
  const XmlElement* const data = header.root.child("PolyData")->child("FieldData");
  if (data == nullptr) {
    return fields;
  }
  for (const XmlElement& array : data->children) {
    const std::string* const name = array.attribute("Name");
    if (array.name == "Array" && name != nullptr && array.attribute_or("type", "") == "String") {
      fields[*name] = first_xml_string(header, array);
    }
  }
  return fields;
}

}  // namespace

TriangleMesh read_vtp(const fs::path& path) {
  std::map<std::string, std::string> ignored;
  std::vector<float> ignored_too;
  return read_vtp(path, ignored, ignored_too);
}

TriangleMesh read_vtp(const fs::path& path, std::map<std::string, std::string>& fields,
                      std::vector<float>& distance) {
  const VtkXmlHeader header = read_poly_data_header(path);
  fields = text_fields(header);
  distance.clear();
  TriangleMesh mesh;
  PolygonCutter polygons(mesh);
  for (const XmlElement& piece : header.root.child("PolyData")->children) {
    if (piece.name != "Piece") {
      continue;
    }
    const std::uint64_t first_point = mesh.positions.size();
    const std::uint64_t count = count_of(header, piece, "NumberOfPoints", 0);
    append_points(mesh, header, piece, count);
    append_cells(header, piece, "Polys", first_point,
                 [&](const auto& corners) { polygons.append(corners); });
    append_cells(header, piece, "Strips", first_point,
                 [&](const auto& corners) { append_strip(mesh, corners); });
    append_distances(distance, header, piece, count);
  }
  polygons.cut_concave();
  if (distance.size() != mesh.positions.size()) {
    distance.clear();  // ignored unless all pieces have them
  }
  return mesh;
}

MeshFileInfo info_in_vtp(const fs::path& path) {
  std::map<std::string, std::string> fields = text_fields(read_poly_data_header(path));
  return {.space = fields["SPACE"], .comment = ""};
}

}  // namespace isoatlas::detail::io
