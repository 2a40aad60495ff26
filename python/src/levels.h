// SPDX-License-Identifier: Apache-2.0
// What Python holds of meshes: the levels of an extraction or of a file.
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

using Words = std::vector<std::pair<std::string, std::string>>;  ///< options by name: what the
                                                                 ///< command line would be given

/// What extract() is asked for, in words.
struct ExtractWords {
  Words settings;     ///< names as on the command line, without dashes
  Words constraints;  ///< for all levels
  std::vector<std::variant<std::string, Words>>
      refine;  ///< for each further level its own; a text is as --refine takes it
  bool coarse = false, allow_self_intersections = false;
};

/// Immutable once it is made, so that views into it are safe and it can be written while others
/// read it.
struct Levels {
  Hierarchy hierarchy;
  HierarchyFileInfo info;
  struct Made {
    ExtractReport report;
    ReportContext context;
  };
  std::optional<Made> made;  ///< none: read from a file
};

/// @throws Error as isoatlas::extract() and the options of the command line; names in messages have
/// underscores
std::shared_ptr<Levels> extract_levels(const ArrayVolume& volume, const ExtractWords& words,
                                       const py::object& progress);

/// A mesh or levels, by the extension.
std::shared_ptr<Levels> read_levels(const std::string& path);

/// Views, read-only, which keep `levels` alive.
py::array vertices_of(const std::shared_ptr<Levels>& levels, std::size_t level);  ///< V x 3 float64
py::array faces_of(const std::shared_ptr<Levels>& levels, std::size_t level);     ///< F x 3 uint32
py::object distance_of(const std::shared_ptr<Levels>& levels,
                       std::size_t level);  ///< V float32; None: not known

/// JSON as the command line's --report has it, without files; empty if they were read.
std::string report_of(const Levels& levels);

/// Writes what -o, --glb-per-level and --report write; all or nothing.
/// @return a warning if rounding causes self-intersections in a file, else empty
std::string save_levels(const std::shared_ptr<Levels>& levels, const std::string& path,
                        const std::optional<std::string>& report, bool glb_per_level);

}  // namespace isoatlas::detail::python
