// SPDX-License-Identifier: Apache-2.0
#include "volume_files/vtk_xml_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <system_error>
#include <utility>

#include "files/file_error.h"
#include "files/stored_data.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse_type(const fs::path& path, const std::string& type) {
  const std::string kind =
      type.starts_with('P') && type.size() > 1 && type[1] >= 'A' && type[1] <= 'Z' ? type.substr(1)
                                                                                   : type;
  const std::string expected = ", expected a volume: ImageData or RectilinearGrid";
  if (kind == "PolyData") {
    throw unsupported(path, "is a mesh file (VTK " + type + ")" + expected);
  }
  if (kind == "StructuredGrid") {
    throw unsupported(path, "holds a curvilinear grid (" + type + ")" + expected +
                                "; resample it to an image first");
  }
  if (kind == "UnstructuredGrid") {
    throw unsupported(path, "holds an unstructured grid (" + type + ")" + expected +
                                "; resample it to an image first");
  }
  if (type == "Collection" || type.starts_with("vtk")) {
    throw unsupported(
        path, "is a list of other files (" + one_line(type, 40) + "), expected one of these files");
  }
  throw unsupported(path, "holds '" + one_line(type, 40) + "'" + expected);
}

PointExtent extent_of(const VtkXmlHeader& header, const XmlElement& element,
                      const std::string& attribute) {
  const std::vector<double> numbers = numbers_of(header, element, attribute, 6);
  PointExtent extent;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double number = numbers[i];
    if (!(std::abs(number) <= std::numeric_limits<std::int32_t>::max()) ||
        number != std::trunc(number)) {
      throw bad_file(header.path, "its " + attribute + " is '" +
                                      one_line(element.attribute_or(attribute, ""), 80) +
                                      "', expected six integers");
    }
    (i % 2 == 0 ? extent.first : extent.last)[i / 2] = static_cast<std::int64_t>(number);
  }
  if (numbers.empty()) {
    throw bad_file(header.path, "has no " + attribute + " in <" + element.name + ">");
  }
  return extent;
}

void require_within(const fs::path& path, const PointExtent& extent, const PointExtent& whole) {
  if (!whole.contains(extent)) {
    throw bad_file(path, "has a piece with extent " + to_string(extent) +
                             ", expected one within the WholeExtent " + to_string(whole));
  }
}

// Adds the pieces that are in the file itself.
void add_pieces(VtkXmlGrid& grid, const std::shared_ptr<const VtkXmlHeader>& header,
                const XmlElement& element, const PointExtent& stated) {
  for (const XmlElement& child : element.children) {
    if (child.name != "Piece") {
      continue;
    }
    const PointExtent extent = extent_of(*header, child, "Extent");
    const PointExtent wanted = extent.intersection(stated);
    if (wanted.is_empty()) {
      continue;
    }
    require_within(header->path, extent, grid.extent);
    grid.pieces.push_back({header, &child, extent, wanted});
  }
}

fs::path piece_file(const fs::path& path, const XmlElement& piece) {
  std::string source = piece.attribute_or("Source", "");
  if (source.empty()) {
    throw bad_file(path, "has a piece without a Source, expected the name of its file");
  }
  std::error_code ignored;
  fs::path file = path.parent_path() / source;
  if (!fs::exists(file, ignored) &&
      source.find('\\') != std::string::npos) {  // a path written on Windows
    std::ranges::replace(source, '\\', '/');
    file = path.parent_path() / source;
  }
  return file;
}

void add_files(VtkXmlGrid& grid, const std::string& piece_type) {
  const fs::path& path = grid.header->path;
  std::map<fs::path, std::shared_ptr<const VtkXmlHeader>>
      headers;  // several pieces may name the same file
  for (const XmlElement& piece : grid.element->children) {
    const bool is_piece = piece.name == "Piece";
    const PointExtent extent = is_piece ? extent_of(*grid.header, piece, "Extent") : PointExtent{};
    if (extent.is_empty()) {
      continue;
    }
    require_within(path, extent, grid.extent);
    const fs::path file = piece_file(path, piece);
    check_data_file(path, file, [&] {
      readable_file_size(file);
      std::shared_ptr<const VtkXmlHeader>& header = headers[file];
      if (!header) header = std::make_shared<const VtkXmlHeader>(read_vtk_xml_header(file));
      const XmlElement* const element = header->root.child(piece_type);
      if (header->root.attribute_or("type", "") != piece_type || element == nullptr) {
        throw bad_file(file, "holds '" + one_line(header->root.attribute_or("type", ""), 40) +
                                 "', expected " + piece_type);
      }
      const std::size_t pieces = grid.pieces.size();
      add_pieces(grid, header, *element, extent);
      if (grid.pieces.size() == pieces) {
        throw bad_file(file, "holds no samples of extent " + to_string(extent));
      }
    });
  }
}

}  // namespace

bool PointExtent::is_empty() const {
  return last[0] < first[0] || last[1] < first[1] || last[2] < first[2];
}

bool PointExtent::contains(const PointExtent& other) const { return intersection(other) == other; }

PointExtent PointExtent::intersection(const PointExtent& other) const {
  PointExtent both;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    both.first[axis] = std::max(first[axis], other.first[axis]);
    both.last[axis] = std::min(last[axis], other.last[axis]);
  }
  return both;
}

std::array<std::size_t, 3> PointExtent::size() const {
  std::array<std::size_t, 3> size{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    size[axis] = static_cast<std::size_t>(std::max<std::int64_t>(last[axis] - first[axis] + 1, 0));
  }
  return size;
}

std::string to_string(const PointExtent& extent) {
  std::string text;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    text += axis > 0 ? " " : "";
    text += std::to_string(extent.first[axis]);
    text += ' ';
    text += std::to_string(extent.last[axis]);
  }
  return text;
}

VtkXmlGrid read_vtk_xml_grid(const fs::path& path) {
  VtkXmlGrid grid;
  grid.header = std::make_shared<const VtkXmlHeader>(read_vtk_xml_header(path));
  const std::string type = grid.header->root.attribute_or("type", "");
  grid.is_parallel = type == "PImageData" || type == "PRectilinearGrid";
  grid.is_rectilinear = type.ends_with("RectilinearGrid");
  if (!grid.is_parallel && type != "ImageData" && type != "RectilinearGrid") {
    refuse_type(path, type);
  }
  grid.element = grid.header->root.child(type);
  if (grid.element == nullptr) {
    throw bad_file(path, "has no element <" + type + ">");
  }
  grid.extent = extent_of(*grid.header, *grid.element, "WholeExtent");
  if (grid.is_parallel) {
    add_files(grid, type.substr(1));
  } else {
    add_pieces(grid, grid.header, *grid.element, grid.extent);
  }
  return grid;
}

}  // namespace isoatlas::detail::io
