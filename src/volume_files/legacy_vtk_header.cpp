// SPDX-License-Identifier: Apache-2.0
#include "volume_files/legacy_vtk_header.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "files/file_error.h"
#include "volume_files/grid_of_file.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

// A section KEYWORD NAME [components] TYPE, followed by values. Identifiers and texture coordinates
// are not volumes.
struct ValueSection {
  std::string_view keyword;
  std::uint64_t components;
  bool is_volume = true;
  bool states_components = false;
};

constexpr std::array kValueSections{
    ValueSection{"vectors", 3},           ValueSection{"normals", 3},
    ValueSection{"tensors", 9},           ValueSection{"tensors6", 6},
    ValueSection{"global_ids", 1, false}, ValueSection{"pedigree_ids", 1, false},
    ValueSection{"edge_flags", 1, false}, ValueSection{"texture_coordinates", 0, false, true}};

std::string shape_of(const std::array<std::size_t, 3>& size) {
  return std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " +
         std::to_string(size[2]);
}

class HeaderReader {
 public:
  explicit HeaderReader(const fs::path& path) : path_(path), scanner_(path) {}

  LegacyVtkHeader read() {
    read_first_lines();
    for (;;) {
      const std::uint64_t bytes_left = scanner_.bytes_left();
      const std::string keyword = scanner_.keyword();
      if (keyword.empty()) {
        break;
      }
      if (is_legacy_vtk_keyword(keyword)) {
        read_section(keyword);
      } else if (header_.arrays.empty()) {
        throw bad_file(path_,
                       "has '" + one_line(keyword, 40) +
                           "' where a section should begin, expected DIMENSIONS, POINT_DATA, " +
                           "SCALARS or another");
      } else {
        header_.ignored_bytes = bytes_left;
        break;
      }
    }
    if (is_rectilinear_) {
      apply_coordinates();
    } else {
      move_origin_to_first_point();
    }
    std::stable_partition(header_.arrays.begin(), header_.arrays.end(),
                          [](const LegacyVtkArray& array) { return !array.array.is_cell_data; });
    return std::move(header_);
  }

 private:
  void read_first_lines() {
    scanner_.line();  // # vtk DataFile Version 3.0
    scanner_.line();  // a title: any text
    const std::string encoding = scanner_.keyword();
    if (encoding != "ascii" && encoding != "binary") {
      throw bad_file(path_, "its third line begins with '" + one_line(encoding, 40) +
                                "', expected ASCII or BINARY");
    }
    header_.is_text = encoding == "ascii";
    scanner_.set_text(header_.is_text);
    if (scanner_.keyword() != "dataset") {
      throw unsupported(
          path_, "holds no DATASET, expected a volume: STRUCTURED_POINTS or RECTILINEAR_GRID");
    }
    const std::string dataset = scanner_.keyword();
    is_rectilinear_ = dataset == "rectilinear_grid";
    if (!is_rectilinear_ && dataset != "structured_points") {
      refuse_dataset(dataset);
    }
  }

  [[noreturn]] void refuse_dataset(const std::string& dataset) const {
    const std::string expected = ", expected a volume: STRUCTURED_POINTS or RECTILINEAR_GRID";
    if (dataset == "polydata") {
      throw unsupported(path_, "is a mesh file (POLYDATA)" + expected);
    }
    if (dataset == "structured_grid") {
      throw unsupported(path_, "holds a curvilinear grid (STRUCTURED_GRID)" + expected +
                                   "; resample it to an image first");
    }
    if (dataset == "unstructured_grid") {
      throw unsupported(path_, "holds an unstructured grid (UNSTRUCTURED_GRID)" + expected +
                                   "; resample it to an image first");
    }
    throw unsupported(path_, "holds a DATASET '" + one_line(dataset, 40) + "'" + expected);
  }

  void read_section(const std::string& keyword) {
    if (keyword == "dimensions") {
      for (std::size_t& points : header_.grid.points)
        points = static_cast<std::size_t>(scanner_.count("a number of points"));
    } else if (keyword == "extent") {
      read_extent();
    } else if (keyword == "spacing" || keyword == "aspect_ratio") {
      header_.grid.spacing = scanner_.vector("a spacing");
      header_.has_spacing = true;
    } else if (keyword == "origin") {
      header_.grid.origin = scanner_.vector("a coordinate of the origin");
    } else if (keyword == "point_data" || keyword == "cell_data") {
      begin_attributes(keyword == "cell_data");
    } else if (keyword == "metadata") {
      skip_metadata();
    } else if (keyword == "field") {
      read_field();
    } else if (keyword == "lookup_table") {
      skip_lookup_table();
    } else if (keyword == "scalars" || keyword == "color_scalars") {
      read_scalars(keyword == "color_scalars");
    } else if (keyword.ends_with("_coordinates") &&
               keyword.size() == std::string_view("x_coordinates").size()) {
      read_coordinates(static_cast<std::size_t>(keyword[0] - 'x'));
    } else {
      read_values(keyword);
    }
  }

  // Reads EXTENT x0 x1 y0 y1 z0 z1, an alternative to DIMENSIONS: the indices of the first and last
  // point along each axis.
  void read_extent() {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t first = scanner_.integer("the first index of an axis"),
                         last = scanner_.integer("the last index of an axis");
      if (first < std::numeric_limits<std::int32_t>::min() ||
          last > std::numeric_limits<std::int32_t>::max() || last < first) {
        throw bad_file(path_, "its EXTENT goes from " + std::to_string(first) + " to " +
                                  std::to_string(last) + " along " + "xyz"[axis] +
                                  ", expected 32-bit indices in increasing order");
      }
      header_.grid.points[axis] = static_cast<std::size_t>(last - first + 1);
      first_index_[axis] = static_cast<double>(first);
    }
  }

  // ORIGIN and SPACING may follow EXTENT.
  void move_origin_to_first_point() {
    header_.grid.origin.x += first_index_[0] * header_.grid.spacing.x;
    header_.grid.origin.y += first_index_[1] * header_.grid.spacing.y;
    header_.grid.origin.z += first_index_[2] * header_.grid.spacing.z;
  }

  void begin_attributes(bool is_cell_data) {
    has_attributes_ = true;
    is_cell_data_ = is_cell_data;
    tuples_ = scanner_.count("a number of values");
    const std::array<std::size_t, 3> size =
        is_cell_data ? header_.grid.cells() : header_.grid.points;
    std::uint64_t expected = 1;
    for (const std::size_t samples : size) {
      const std::uint64_t factor = is_cell_data ? std::max<std::uint64_t>(samples, 1) : samples;
      if (factor > 0 &&
          expected >
              static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()) / factor) {
        throw bad_file(path_, "the header states " + shape_of(header_.grid.points) +
                                  " samples, more than any file can hold");
      }
      expected *= factor;
    }
    if (tuples_ != expected) {
      throw bad_file(path_, std::string("its ") + (is_cell_data ? "CELL_DATA" : "POINT_DATA") +
                                " states " + std::to_string(tuples_) +
                                " values, but its dimensions " + shape_of(header_.grid.points) +
                                " require " + std::to_string(expected));
    }
  }

  // Reads SCALARS name type [components], LOOKUP_TABLE name, values; the table's line is optional.
  // COLOR_SCALARS name components, values: VTK writes all volumes of unsigned char like this,
  // whether or not they are colours.
  void read_scalars(bool is_colour) {
    LegacyVtkArray array;
    array.array.name = scanner_.name();
    array.array.is_marked = true;
    if (is_colour) {
      array.array.components = scanner_.count("a number of components");
      array.is_colour_text = header_.is_text;
      return add(std::move(array), "unsigned_char");
    }
    const std::string type = scanner_.keyword();
    array.array.components = scanner_.count_in_line("a number of components", 1);
    scanner_.skip_line_of("lookup_table");
    add(std::move(array), type, true, false);
  }

  void read_values(const std::string& keyword) {
    const auto* const section = std::ranges::find(kValueSections, keyword, &ValueSection::keyword);
    if (section == kValueSections.end()) {
      throw bad_file(path_, "has a second " + keyword);
    }
    LegacyVtkArray array;
    array.array.name = scanner_.name();
    array.array.components =
        section->states_components ? scanner_.count("a number of components") : section->components;
    add(std::move(array), scanner_.keyword(), section->is_volume);
  }

  // Reads values, one tuple for each point or cell.
  void add(LegacyVtkArray array, const std::string& type, bool is_volume = true,
           bool begins_in_next_line = true) {
    if (!has_attributes_) {
      throw bad_file(path_, "its values of '" + one_line(array.array.name, 80) +
                                "' precede POINT_DATA or CELL_DATA");
    }
    array.tuples = tuples_;
    scanner_.locate_values(array, type, begins_in_next_line);
    keep(std::move(array), is_volume);
  }

  void keep(LegacyVtkArray array, bool is_volume) {
    last_components_ = array.array.components;
    is_last_kept_ = has_attributes_ && is_volume && !is_ghost_array(array.array.name);
    if (is_last_kept_) {
      array.array.is_cell_data = is_cell_data_;
      header_.arrays.push_back(std::move(array));
    }
  }

  void skip_lookup_table() {
    LegacyVtkArray table;
    scanner_.name();
    table.array.components = 4;
    table.tuples = scanner_.count("a number of colours");
    scanner_.locate_values(table, "unsigned_char");
  }

  // Reads FIELD name arrays, and for each array: name components tuples type, values.
  void read_field() {
    scanner_.name();
    const std::uint64_t arrays = scanner_.count("a number of arrays");
    for (std::uint64_t i = 0; i < arrays; ++i) {
      LegacyVtkArray array;
      array.array.name = scanner_.name();
      if (i > 0 && array.array.name == "METADATA") {  // metadata of the previous array
        skip_metadata();
        array.array.name = scanner_.name();
      }
      if (array.array.name.empty()) {
        throw bad_file(path_, "is cut off: a FIELD has " + std::to_string(i) +
                                  " arrays, expected " + std::to_string(arrays));
      }
      if (array.array.name == "NULL_ARRAY") {
        continue;
      }
      array.array.components = scanner_.count("a number of components");
      array.tuples = scanner_.count("a number of values");
      scanner_.locate_values(array, scanner_.keyword(), true, i + 1 < arrays);
      const bool is_volume = !array.is_string;
      keep(std::move(array), is_volume);
    }
  }

  // Reads COMPONENT_NAMES with a line for each, INFORMATION, and the empty line at the end.
  void skip_metadata() {
    scanner_.line();
    while (scanner_.bytes_left() > 0) {
      const std::string line = scanner_.line();
      if (line.empty()) {
        return;
      }
      for (std::uint64_t i = 0;
           line == "COMPONENT_NAMES" && i < last_components_ && scanner_.bytes_left() > 0; ++i) {
        const std::string name = decoded_name(scanner_.line());
        if (is_last_kept_) {
          header_.arrays.back().array.component_names.push_back(name);
        }
      }
    }
  }

  void read_coordinates(std::size_t axis) {
    LegacyVtkArray array;
    array.tuples = scanner_.count("a number of coordinates");
    scanner_.locate_values(array, scanner_.keyword());
    if (array.is_string || array.tuples != header_.grid.points[axis]) {
      throw bad_file(path_, "has " + std::to_string(array.tuples) + " " + "xyz"[axis] +
                                " coordinates, expected " +
                                std::to_string(header_.grid.points[axis]));
    }
    coordinates_[axis] = coordinates_of_axis(*open_values(path_, header_.is_text, array),
                                             array.array.type, array.tuples, header_.is_text);
  }

  void apply_coordinates() {
    const std::array<double*, 3> spacing{&header_.grid.spacing.x, &header_.grid.spacing.y,
                                         &header_.grid.spacing.z};
    const std::array<double*, 3> origin{&header_.grid.origin.x, &header_.grid.origin.y,
                                        &header_.grid.origin.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (coordinates_[axis].values.size() != header_.grid.points[axis]) {
        throw bad_file(path_, std::string("has no ") + "xyz"[axis] + " coordinates");
      }
      const EvenSteps even = even_steps(path_, coordinates_[axis], "xyz"[axis]);
      *origin[axis] = even.first;
      *spacing[axis] = even.step;
    }
    header_.has_spacing = true;
  }

  fs::path path_;
  LegacyVtkScanner scanner_;
  LegacyVtkHeader header_;
  bool is_rectilinear_ = false;
  std::array<double, 3> first_index_{};  // from EXTENT
  std::array<AxisCoordinates, 3> coordinates_;
  bool has_attributes_ = false, is_cell_data_ = false;  // after POINT_DATA or CELL_DATA
  std::uint64_t tuples_ = 0;                            // of POINT_DATA or CELL_DATA
  std::uint64_t last_components_ = 0;                   // of the previous array
  bool is_last_kept_ = false;
};

}  // namespace

LegacyVtkHeader read_legacy_vtk_header(const fs::path& path) { return HeaderReader(path).read(); }

}  // namespace isoatlas::detail::io
