// SPDX-License-Identifier: Apache-2.0
#include "volume_files/vtk_xml_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "files/file_error.h"
#include "files/stored_data.h"
#include "files/vtk_xml_values.h"
#include "volume_files/grid_of_file.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

// The attribute of the header, or of the first piece's file if the header lacks it: a .pvti need
// not have a Direction.
std::vector<double> image_numbers(const VtkXmlGrid& grid, const char* attribute,
                                  std::size_t count) {
  std::vector<double> numbers = numbers_of(*grid.header, *grid.element, attribute, count);
  if (numbers.empty() && grid.is_parallel && !grid.pieces.empty()) {
    const VtkXmlHeader& piece = *grid.pieces.front().header;
    numbers = numbers_of(piece, *piece.root.child("ImageData"), attribute, count);
  }
  return numbers;
}

// A piece whose file states another grid belongs to another volume.
void require_same_in_pieces(const VtkXmlGrid& grid, const char* attribute,
                            const std::vector<double>& expected, double tolerance) {
  for (const VtkXmlPiece& piece : grid.pieces) {
    if (!grid.is_parallel) {
      return;
    }
    const std::vector<double> numbers = numbers_of(
        *piece.header, *piece.header->root.child("ImageData"), attribute, expected.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (!(std::abs(numbers[i] - expected[i]) <= tolerance)) {
        throw bad_file(grid.header->path,
                       "its piece " + piece.header->path.filename().string() + " has another " +
                           attribute + ", expected " +
                           grid.element->attribute_or(attribute, "that of the first piece"));
      }
    }
  }
}

VtkGrid image_geometry(const VtkXmlGrid& grid, VolumeSource& source) {
  VtkGrid geometry{.points = grid.extent.size()};
  geometry.first = grid.extent.first;
  double tolerance = 1e-6;  // of the smallest step
  if (const std::vector<double> spacing = image_numbers(grid, "Spacing", 3); !spacing.empty()) {
    geometry.spacing = {spacing[0], spacing[1], spacing[2]};
    tolerance *= std::min({std::abs(spacing[0]), std::abs(spacing[1]), std::abs(spacing[2])});
    require_same_in_pieces(grid, "Spacing", spacing, tolerance);
  } else {
    source.has_spacing = false;
  }
  if (const std::vector<double> origin = image_numbers(grid, "Origin", 3); !origin.empty()) {
    geometry.origin = {origin[0], origin[1], origin[2]};
    require_same_in_pieces(grid, "Origin", origin, 1e3 * tolerance);
  }
  if (const std::vector<double> rows = image_numbers(grid, "Direction", 9); !rows.empty()) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      geometry.axes[axis] = {rows[axis], rows[3 + axis], rows[6 + axis]};
    }
    require_same_in_pieces(grid, "Direction", rows, 1e-6);
  }
  return geometry;
}

class Coordinates {
 public:
  Coordinates(const VtkXmlGrid& grid, const ReadOptions& options)
      : grid_(grid), options_(options), points_(grid.extent.size()) {}

  AxisCoordinates along(std::size_t axis) {
    AxisCoordinates all;
    for (const VtkXmlPiece& piece : grid_.pieces) {
      check_data_file(grid_.header->path, piece.header->path, [&] { add(piece, axis, all); });
    }
    if (all.values.size() != points_[axis] ||
        std::ranges::any_of(all.values, [](double value) { return std::isnan(value); })) {
      throw bad_file(grid_.header->path, std::string("does not have all ") + "xyz"[axis] +
                                             " coordinates of its WholeExtent");
    }
    return all;
  }

 private:
  void add(const VtkXmlPiece& piece, std::size_t axis, AxisCoordinates& all) const {
    const XmlElement* const element = piece.element->child("Coordinates");
    if (element == nullptr || element->children.size() < 3) {
      throw bad_file(piece.header->path,
                     "has no <Coordinates> with three arrays in one of its pieces");
    }
    const XmlElement& array = element->children[axis];
    const std::optional<VtkType> type = vtk_xml_type(*piece.header, array);
    if (!type) {
      throw bad_file(piece.header->path, std::string("its ") + "xyz"[axis] +
                                             " coordinates are strings, expected numbers");
    }
    const std::uint64_t count = piece.extent.size()[axis];
    const auto values = open_xml_values(*piece.header, array, *type, count);
    require_within_memory_limit(piece.header->path, (count + points_[axis]) * sizeof(double),
                                options_);
    const AxisCoordinates part =
        coordinates_of_axis(*values, *type, count, array.attribute_or("format", "") == "ascii");
    if (all.values.empty()) {
      all.values.assign(points_[axis], std::numeric_limits<double>::quiet_NaN());
    }
    all.rounding = std::max(all.rounding, part.rounding);
    const auto first =
        static_cast<std::size_t>(piece.extent.first[axis] - grid_.extent.first[axis]);
    std::ranges::copy(part.values, all.values.begin() + static_cast<std::ptrdiff_t>(first));
  }

  const VtkXmlGrid& grid_;
  const ReadOptions& options_;
  std::array<std::size_t, 3> points_;
};

VtkGrid rectilinear_geometry(const VtkXmlGrid& grid, const ReadOptions& options,
                             VolumeSource& source) {
  VtkGrid geometry{.points = grid.extent.size()};
  const std::array<double*, 3> spacing{&geometry.spacing.x, &geometry.spacing.y,
                                       &geometry.spacing.z};
  const std::array<double*, 3> origin{&geometry.origin.x, &geometry.origin.y, &geometry.origin.z};
  Coordinates coordinates(grid, options);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const EvenSteps even = even_steps(grid.header->path, coordinates.along(axis), "xyz"[axis]);
    *origin[axis] = even.first;
    *spacing[axis] = even.step;
  }
  source.decisions.push_back({"spacing", "the equal steps of the coordinates"});
  return geometry;
}

}  // namespace

VtkGrid vtk_xml_geometry(const VtkXmlGrid& grid, const ReadOptions& options, VolumeSource& source) {
  return grid.is_rectilinear ? rectilinear_geometry(grid, options, source)
                             : image_geometry(grid, source);
}

}  // namespace isoatlas::detail::io
