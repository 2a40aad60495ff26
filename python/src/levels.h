// SPDX-License-Identifier: Apache-2.0
// The C++ side of isoatlas.Mesh: the levels of an extraction or of a file.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "array_volume.h"
#include "isoatlas/extract.h"
#include "isoatlas/io.h"
#include "report/report.h"

namespace isoatlas::detail::python {

/// Options: pairs of a name and a value, as texts of the command line.
using Words = std::vector<std::pair<std::string, std::string>>;

/// The options of extract() as texts.
struct ExtractWords {
  Words settings;     ///< names as on the command line, without dashes
  Words constraints;  ///< for all levels
  /// The constraints of each further level: the text of --refine, or options.
  std::vector<std::variant<std::string, Words>> refine;
  bool coarse = false, allow_self_intersections = false;
};

/// The levels of a mesh. Immutable after construction, so views of the arrays stay valid, and other
/// threads may read the levels while they are saved.
struct Levels {
  Hierarchy hierarchy;
  HierarchyFileInfo info;
  struct Extracted {
    ExtractReport report;
    ReportContext context;
  };
  std::optional<Extracted> extracted;  ///< empty if the levels were read from a file
};

/// Extracts the isosurface. Messages name options with underscores.
/// @throws Error like isoatlas::extract() and like the options of the command line
std::shared_ptr<Levels> extract_levels(const ArrayVolume& volume, const ExtractWords& words,
                                       const py::object& progress);

/// Reads a mesh or levels; the extension decides which.
/// @throws Error(bad_file, unsupported)
std::shared_ptr<Levels> read_levels(const std::string& path);

/// Read-only views, which keep `levels` alive: V x 3 float64, F x 3 uint32, and V float32 or None
/// if the distances are not known.
py::array vertices_of(const std::shared_ptr<Levels>& levels, std::size_t level);
py::array faces_of(const std::shared_ptr<Levels>& levels, std::size_t level);
py::object distance_of(const std::shared_ptr<Levels>& levels, std::size_t level);

/// The JSON of --report, without files; empty if the levels were read from a file.
std::string report_of(const Levels& levels);

/// The page of --html with the levels [0, level_count), without the comparison with marching cubes,
/// which needs the volume.
/// @throws Error(unsupported) if this isoatlas was built without pages
/// @cost  as page_html()
std::string page_of(const std::shared_ptr<Levels>& levels, std::size_t level_count);

/// Writes the files of -o, --glb-per-level and --report: all of them, or none on an error. A name
/// that ends in .html is that of a page.
/// @return a warning if rounding causes self-intersections in a file, else an empty text
/// @throws Error(bad_argument, bad_file, unsupported)
std::string save_levels(const std::shared_ptr<Levels>& levels, const std::string& path,
                        const std::optional<std::string>& report, bool glb_per_level);

/// Writes the mesh of --neuroglancer. @throws Error(bad_file)
void save_neuroglancer(const std::shared_ptr<Levels>& levels, const std::string& folder);

}  // namespace isoatlas::detail::python
