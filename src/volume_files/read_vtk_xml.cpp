// SPDX-License-Identifier: Apache-2.0
// VTK XML images and rectilinear grids with equal steps. VTK's own reader returns uninitialised
// memory if base64 text or an LZ4 block ends early, and allocates what a header states. So the
// values are decoded here, and either all or none are returned.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "files/byte_source.h"
#include "files/file_error.h"
#include "files/stored_data.h"
#include "files/vtk_xml_values.h"
#include "volume_files/choice.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/readers.h"
#include "volume_files/vtk_array.h"
#include "volume_files/vtk_xml_assembly.h"
#include "volume_files/vtk_xml_geometry.h"
#include "volume_files/vtk_xml_grid.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

// A step of a time series; empty if the file has no series.
using TimeStep = std::optional<std::size_t>;

// An array without TimeStep is the same at all times.
bool is_of_step(const VtkXmlHeader& header, const XmlElement& array, TimeStep step) {
  const std::vector<double> steps = numbers_of(header, array, "TimeStep", 0);
  return !step || steps.empty() ||
         std::ranges::find(steps, static_cast<double>(*step)) != steps.end();
}

TimeStep choose_time(const VtkXmlGrid& grid, const ReadOptions& options, VolumeSource& source) {
  const std::size_t count = numbers_of(*grid.header, *grid.element, "TimeValues", 0).size();
  if (count == 0) {
    return {};
  }
  return take_choice(grid.header->path, source, numbered_choice("time", count), options.time);
}

std::uint64_t components_of(const VtkXmlHeader& header, const XmlElement& array) {
  const std::vector<double> number = numbers_of(header, array, "NumberOfComponents", 1);
  constexpr double kMost = 1e9;
  return number.empty()                         ? 1
         : number[0] >= 0 && number[0] <= kMost ? static_cast<std::uint64_t>(number[0])
                                                : 0;
}

VtkArray description_of(const VtkXmlHeader& header, const XmlElement& array, VtkType type) {
  VtkArray description{.name = array.attribute_or("Name", ""),
                       .type = type,
                       .components = components_of(header, array)};
  for (std::size_t i = 0;
       i < std::min<std::uint64_t>(description.components, array.attributes.size()); ++i) {
    description.component_names.push_back(
        array.attribute_or("ComponentName" + std::to_string(i), ""));
  }
  return description;
}

// The arrays of numbers, first of points and then of cells, as the file's header or its first piece
// lists them.
std::vector<VtkArray> arrays_of(const VtkXmlGrid& grid, TimeStep step) {
  const std::string prefix = grid.is_parallel ? "P" : "";
  const XmlElement* const list = grid.is_parallel      ? grid.element
                                 : grid.pieces.empty() ? nullptr
                                                       : grid.pieces.front().element;
  std::vector<VtkArray> arrays;
  for (const std::string kind : {"PointData", "CellData"}) {
    const XmlElement* const attributes = list == nullptr ? nullptr : list->child(prefix + kind);
    if (attributes == nullptr) {
      continue;
    }
    for (const XmlElement& array : attributes->children) {
      if (array.name != prefix + "DataArray") {
        continue;  // <Array>: strings
      }
      const std::string name = array.attribute_or("Name", "");
      const auto is_marked_as = [&](const char* what) {
        return !name.empty() && attributes->attribute_or(what, "") == name;
      };
      const std::optional<VtkType> type = vtk_xml_type(*grid.header, array);
      if (!type || is_ghost_array(name) || is_marked_as("GlobalIds") ||
          is_marked_as("PedigreeIds") || !is_of_step(*grid.header, array, step)) {
        continue;
      }
      arrays.push_back(description_of(*grid.header, array, *type));
      arrays.back().is_cell_data = kind == "CellData";
      arrays.back().is_marked = is_marked_as("Scalars");
    }
  }
  return arrays;
}

const XmlElement* find_array(const VtkXmlPiece& piece, const std::string& name, bool is_cell_data,
                             TimeStep step) {
  const XmlElement* const attributes =
      piece.element->child(is_cell_data ? "CellData" : "PointData");
  for (std::size_t i = 0; attributes != nullptr && i < attributes->children.size(); ++i) {
    const XmlElement& array = attributes->children[i];
    if (array.name == "DataArray" && array.attribute_or("Name", "") == name &&
        is_of_step(*piece.header, array, step)) {
      return &array;
    }
  }
  return nullptr;
}

class SampleReader {
 public:
  SampleReader(const VtkXmlGrid& grid, const VtkArray& array, std::uint64_t component,
               TimeStep step)
      : grid_(grid), array_(array), component_(component), step_(step) {}

  std::shared_ptr<std::byte[]> read(const std::array<std::size_t, 3>& size,
                                    const ReadOptions& options, VolumeSource& source) {
    const fs::path& path = grid_.header->path;
    const std::uint64_t bytes =
        checked_sample_bytes(path, size, bytes_per_sample(array_.type.sample));
    checked_sample_bytes(
        path, size,
        bytes_per_sample(array_.type.sample) * static_cast<std::size_t>(array_.components));
    require_possible(bytes);
    if (grid_.pieces.size() == 1 && grid_.pieces[0].extent == grid_.extent &&
        copies_of(grid_.pieces[0], source).empty()) {
      const auto values = open(grid_.pieces[0]);
      const std::shared_ptr<std::byte[]> samples = allocate_samples(path, bytes, options);
      read_component(*values, array_.type.sample, array_.components, component_,
                     all(grid_.extent).count(), samples.get());
      return samples;
    }
    const std::shared_ptr<std::byte[]> samples = allocate_samples(path, bytes, options);
    PieceAssembly assembly(path, size, array_.type.sample, samples.get());
    for (const VtkXmlPiece& piece : grid_.pieces) {
      check_data_file(path, piece.header->path, [&] {
        const std::vector<bool> copies = copies_of(piece, source);
        assembly.add(*open(piece), array_.components, component_, all(piece.extent),
                     all(piece.wanted), copies);
      });
    }
    assembly.finish(source);
    return samples;
  }

 private:
  SampleBox all(const PointExtent& extent) const {
    SampleBox box{.first = {}, .size = extent.size()};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.first[axis] = static_cast<std::size_t>(
          std::max<std::int64_t>(extent.first[axis] - grid_.extent.first[axis], 0));
      box.size[axis] -= array_.is_cell_data && box.size[axis] > 0 ? 1 : 0;
    }
    return box;
  }

  void require_possible(std::uint64_t bytes) const {
    constexpr std::uint64_t kMostBytesPerByte = 10'000;  // LZMA on constant data
    std::uint64_t stored = readable_file_size(grid_.header->path);
    const fs::path* last = &grid_.header->path;
    for (const VtkXmlPiece& piece : grid_.pieces) {
      stored += piece.header->path == *last ? 0 : readable_file_size(piece.header->path);
      last = &piece.header->path;
    }
    require_possible_bytes(grid_.header->path, bytes, stored, kMostBytesPerByte);
  }

  std::unique_ptr<VtkValues> open(const VtkXmlPiece& piece) const {
    const fs::path& path = piece.header->path;
    const std::string name = "array '" + one_line(array_.name, 80) + "'";
    const XmlElement* const element = find_array(piece, array_.name, array_.is_cell_data, step_);
    if (element == nullptr) {
      throw bad_file(path, "has no " + name + " in one of its pieces");
    }
    const std::optional<VtkType> type = vtk_xml_type(*piece.header, *element);
    if (type != array_.type || components_of(*piece.header, *element) != array_.components) {
      throw bad_file(path, "its " + name + " has other values in one piece, expected " +
                               std::to_string(array_.components) + " of type " +
                               std::string(array_.type.name()) + " per sample");
    }
    const std::uint64_t samples = all(piece.extent).count();
    const std::vector<double> tuples = numbers_of(*piece.header, *element, "NumberOfTuples", 1);
    if (!tuples.empty() && tuples[0] != static_cast<double>(samples)) {
      throw bad_file(path, "its " + name + " states NumberOfTuples " +
                               element->attribute_or("NumberOfTuples", "") + ", expected " +
                               std::to_string(samples) + " for the extent of its piece");
    }
    return open_xml_values(*piece.header, *element, array_.type, samples * array_.components);
  }

  // Marks the samples of a piece that are copies of another piece's samples; empty if there are
  // none. Warns of hidden samples.
  std::vector<bool> copies_of(const VtkXmlPiece& piece, VolumeSource& source) const {
    const XmlElement* element = find_array(piece, "vtkGhostType", array_.is_cell_data, step_);
    const bool is_level = element == nullptr;
    if (is_level) {
      element = find_array(piece, "vtkGhostLevels", array_.is_cell_data, step_);
    }
    if (element == nullptr || vtk_xml_type(*piece.header, *element) != VtkType{SampleType::uint8}) {
      return {};
    }
    const unsigned copied = is_level ? 0xFFU : 1U, hidden = is_level              ? 0U
                                                            : array_.is_cell_data ? 32U
                                                                                  : 2U;
    const SampleBox box = all(piece.extent);
    const auto values = open_xml_values(*piece.header, *element, {SampleType::uint8}, box.count());
    std::vector<bool> copies;
    std::vector<std::uint8_t> row(box.size[0]);
    bool has_hidden = false;
    for (std::uint64_t rows = std::uint64_t{box.size[1]} * box.size[2]; rows > 0; --rows) {
      values->read(row.data(), row.size());
      for (const std::uint8_t flags : row) {
        copies.push_back((flags & copied) != 0);
        has_hidden = has_hidden || (flags & hidden) != 0;
      }
    }
    const std::string warning =
        "marks samples as hidden (vtkGhostType); they are used like all others";
    if (has_hidden && std::ranges::find(source.warnings, warning) == source.warnings.end()) {
      source.warnings.push_back(warning);
    }
    return std::ranges::find(copies, true) == copies.end() ? std::vector<bool>{} : copies;
  }

  const VtkXmlGrid& grid_;
  const VtkArray& array_;
  std::uint64_t component_;
  TimeStep step_;
};

}  // namespace

VolumeFile read_vtk_xml(const fs::path& path, const ReadOptions& options) {
  if (packing_of(path) != Packing::none) {
    throw unsupported(path,
                      "is a compressed VTK XML file, expected one that is decompressed first");
  }
  const VtkXmlGrid grid = read_vtk_xml_grid(path);
  VolumeFile file;
  VolumeSource& source = file.source;
  source.format = std::string("VTK XML ") + (grid.is_parallel ? "parallel " : "") +
                  (grid.is_rectilinear ? "rectilinear grid" : "image data");
  source.reader =
      vtk_xml_reader_name(grid.pieces.empty() ? *grid.header : *grid.pieces.front().header);
  checked_sample_bytes(path, grid.extent.size(), 1);
  const TimeStep step = choose_time(grid, options, source);
  const std::vector<VtkArray> arrays = arrays_of(grid, step);
  if (grid.pieces.empty()) {
    throw bad_file(path, "has no pieces, expected some that cover its WholeExtent");
  }
  const VtkGrid geometry = vtk_xml_geometry(grid, options, source);
  const VtkArray& array = arrays[choose_array(path, arrays, options, source)];
  const std::uint64_t component = choose_component(path, array, options, source);
  if (grid.pieces.size() > 1) {
    source.decisions.push_back({"pieces", std::to_string(grid.pieces.size())});
  }
  Volume& volume = file.volume;
  volume.view.grid = sample_grid(path, geometry, array.is_cell_data, source);
  volume.view.type = array.type.sample;
  const std::shared_ptr<std::byte[]> samples =
      SampleReader(grid, array, component, step).read(volume.view.grid.size, options, source);
  volume.view.samples = samples.get();
  volume.owner = samples;
  return file;
}

}  // namespace isoatlas::detail::io
