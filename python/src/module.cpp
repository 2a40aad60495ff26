// SPDX-License-Identifier: Apache-2.0
// isoatlas._core: the extension that the Python package (python/isoatlas/) calls. The package has
// checked the arguments and converted each to one form; its docstrings describe what users pass.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "array_volume.h"
#include "blocks.h"
#include "check.h"
#include "components.h"
#include "errors.h"
#include "interruptible.h"
#include "isoatlas/error.h"
#include "isoatlas/io.h"
#include "isoatlas/version.h"
#include "levels.h"
#include "mask.h"
#include "stored.h"
#include "wording/settings.h"

namespace {

using namespace isoatlas;
using namespace isoatlas::detail;
using namespace isoatlas::detail::python;
using py::literals::operator""_a;

// The bytes of a path. Python represents bytes that are not UTF-8 as surrogates.
std::string path_of(const py::object& path) {
  return py::bytes(py::module_::import("os").attr("fsencode")(path));
}

std::optional<std::string> path_or_none(const py::object& path) {
  return path.is_none() ? std::nullopt : std::optional(path_of(path));
}

ReadOptions read_options_of(const Words& words) {
  ReadOptions options;
  for (const auto& [name, text] : words) {
    try {
      set(options, name, text);
    } catch (const Error& error) {
      std::string python_name = name;
      for (char& c : python_name) c = c == '-' ? '_' : c;
      throw Error(error.code(), python_name + ": " + error.what());
    }
  }
  return options;
}

/// @return (array, spacing, origin, direction, unit, source): the array's axes are z, y, x; all
///         others are in the order x, y, z
py::tuple read_volume_as_array(const py::object& path, const Words& words) {
  const auto work = [path = path_of(path), options = read_options_of(words)](const RunControl&) {
    try {
      return read_volume_file(path, options);
    } catch (const ChoiceNeeded& needed) {
      throw Error(needed.code(),
                  needed.what() + ("; choose with " + needed.choice().name + "=0, for example"));
    }
  };
  VolumeFile file = compute_interruptibly(work, {});
  const Volume& volume = file.volume;

  using Owner = std::shared_ptr<const void>;
  const py::capsule owner(new Owner(volume.owner),
                          [](void* it) { delete static_cast<Owner*>(it); });
  const Grid& grid = volume.view.grid;
  const py::array array(py::dtype(std::string(name(volume.view.type))),
                        {grid.size[2], grid.size[1], grid.size[0]}, volume.view.samples, owner);
  const auto tuple = [](Vec3 v) { return py::make_tuple(v.x, v.y, v.z); };
  const auto& d = grid.direction;
  const py::tuple direction =
      py::make_tuple(py::make_tuple(d[0].x, d[1].x, d[2].x), py::make_tuple(d[0].y, d[1].y, d[2].y),
                     py::make_tuple(d[0].z, d[1].z, d[2].z));
  return py::make_tuple(array, tuple(grid.spacing), tuple(grid.origin), direction,
                        std::string(symbol(grid.unit)), std::move(file.source));
}

py::dict decisions_of(const VolumeSource& source) {
  py::dict decisions;
  for (const ReadDecision& decision : source.decisions)
    decisions[py::str(decision.key)] = decision.value;
  return decisions;
}

py::dict choices_of(const VolumeSource& source) {
  py::dict choices;
  for (const FileChoice& choice : source.choices)
    choices[py::str(choice.name)] = py::tuple(py::cast(choice.entries));
  return choices;
}

/// @return per component (first vertex, vertices, triangles, genus, boundary loops, area, volume,
///         low corner, high corner); genus and loops are None if the mesh is not a manifold
py::list components_of_level(const Levels& levels, std::size_t level) {
  if (level >= levels.hierarchy.levels.size()) throw py::index_error("no such level");
  const auto components = [&] {
    const py::gil_scoped_release unlocked;
    return components_of(levels.hierarchy.view(level));
  }();
  const auto tuple = [](Vec3 v) { return py::make_tuple(v.x, v.y, v.z); };
  py::list out;
  for (const ComponentFacts& it : components) {
    std::optional<std::int64_t> genus, loops;
    if (it.topology) {
      genus = it.topology->genus();
      loops = it.topology->boundary_loops;
    }
    out.append(py::make_tuple(it.first_vertex, it.vertices, it.triangles, genus, loops, it.area,
                              it.volume, tuple(it.low), tuple(it.high)));
  }
  return out;
}

// pybind11 before 2.12 knows only the array layout of NumPy 1. With NumPy 2 it would read the first
// element in place of every element.
void require_known_numpy() {
#if PYBIND11_VERSION_HEX < 0x020C0000
  const auto version = py::module_::import("numpy").attr("__version__").cast<std::string>();
  if (std::stoi(version) >= 2) {
    const std::string pybind11_version =
        PYBIND11_TOSTRING(PYBIND11_VERSION_MAJOR) "." PYBIND11_TOSTRING(PYBIND11_VERSION_MINOR);
    throw py::import_error("isoatlas was built with pybind11 " + pybind11_version +
                           ", which supports only NumPy 1, and this is NumPy " + version +
                           "; install numpy<2, or build isoatlas with pybind11 2.12 or later "
                           "(pip install . does)");
  }
#endif
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  require_known_numpy();
  module.attr("__version__") = ISOATLAS_VERSION;
  translate_errors();

  py::class_<VolumeSource>(module, "VolumeSource", "How a volume file was understood.")
      .def_readonly("format", &VolumeSource::format, "The file's format, for example 'NIfTI-1'.")
      .def_readonly("reader", &VolumeSource::reader, "The library that read the file.")
      .def_property_readonly("decisions", &decisions_of,
                             "Decisions of the reader: a dict of texts.")
      .def_property_readonly(
          "choices", &choices_of,
          "Lists in the file of which one entry was read: a dict of tuples of texts.")
      .def_property_readonly(
          "warnings",
          [](const VolumeSource& source) { return py::tuple(py::cast(source.warnings)); },
          "Assumptions of the reader: a tuple of texts.")
      .def("__repr__",
           [](const VolumeSource& source) {
             return "<isoatlas.VolumeSource: " + source.format + ">";
           })
      .def(py::pickle(
          [](const VolumeSource& source) { return py::bytes(stored(source)); },
          [](const py::bytes& bytes) { return volume_source_from(std::string_view(bytes)); }));

  py::class_<ArrayVolume>(module, "ArrayVolume")
      .def(
          py::init([](const py::array& array, const std::string& order,
                      const std::array<double, 3>& spacing, const std::array<double, 3>& origin,
                      const std::array<std::array<double, 3>, 3>& direction, const py::object& path,
                      const std::string& unit, const VolumeSource* source) {
            return array_volume(array, order, spacing, origin, direction,
                                path.is_none() ? std::string() : path_of(path),
                                length_unit_named(unit),
                                source == nullptr ? VolumeSource{} : *source);
          }),
          "array"_a, "order"_a, "spacing"_a, "origin"_a, "direction"_a, "path"_a, "unit"_a,
          "source"_a.none(true));

  py::class_<ExtractWords>(module, "ExtractWords")
      .def(py::init([](const Words& settings, const Words& constraints,
                       const decltype(ExtractWords::refine)& refine, bool coarse,
                       bool allow_self_intersections) {
             return ExtractWords{settings, constraints, refine, coarse, allow_self_intersections};
           }),
           "settings"_a, "constraints"_a, "refine"_a, "coarse"_a, "allow_self_intersections"_a);

  py::class_<Levels, std::shared_ptr<Levels>>(module, "Levels")
      .def("__len__", [](const Levels& levels) { return levels.hierarchy.levels.size(); })
      .def("vertices", &vertices_of, "level"_a)
      .def("faces", &faces_of, "level"_a)
      .def("distance", &distance_of, "level"_a)
      .def("report", &report_of)
      .def("triangle_counts",
           [](const Levels& levels) {
             std::vector<std::size_t> counts;
             for (const Hierarchy::Level& level : levels.hierarchy.levels)
               counts.push_back(level.triangles.size());
             return counts;
           })
      .def("components", &components_of_level, "level"_a)
      .def("page", &page_of, "level_count"_a)
      .def("level_reports", [](const Levels& levels) { return levels.info.levels; })
      .def_property_readonly("space", [](const Levels& levels) { return levels.info.mesh.space; })
      .def_property_readonly("placement",
                             [](const Levels& levels) {
                               return levels.info.placement == Placement::balanced ? "balanced"
                                                                                   : "surface";
                             })
      .def(
          "save",
          [](const std::shared_ptr<Levels>& levels, const py::object& path,
             const py::object& report, bool glb_per_level) {
            return save_levels(levels, path_of(path), path_or_none(report), glb_per_level);
          },
          "path"_a, "report"_a, "glb_per_level"_a)
      .def(
          "save_neuroglancer",
          [](const std::shared_ptr<Levels>& levels, const py::object& folder) {
            save_neuroglancer(levels, path_of(folder));
          },
          "folder"_a)
      .def(py::pickle([](const Levels& levels) { return py::bytes(stored(levels)); },
                      [](const py::bytes& bytes) { return levels_from(std::string_view(bytes)); }));

  py::class_<BlockedArray>(module, "BlockedArray")
      .def(py::init<const std::array<std::size_t, 3>&, const py::dtype&,
                    const std::array<std::size_t, 3>&, const std::string&,
                    const std::array<double, 3>&, const std::array<double, 3>&,
                    const std::array<std::array<double, 3>, 3>&, const std::string&,
                    const ExtractWords&>(),
           "shape"_a, "dtype"_a, "blocks"_a, "order"_a, "spacing"_a, "origin"_a, "direction"_a,
           "unit"_a, "words"_a)
      .def("__len__", &BlockedArray::count)
      .def("slices", &BlockedArray::slices, "block"_a)
      .def("mesh", &BlockedArray::mesh, "block"_a, "samples"_a.noconvert())
      .def("merge", &BlockedArray::merge, "meshes"_a, "samples"_a, "progress"_a);

  module.def("extract", &extract_levels, "volume"_a, "words"_a, "progress"_a);
  module.def("mask_field", &mask_field_of, "labels"_a, "wanted"_a, "connectivity"_a, "threads"_a,
             "progress"_a);
  module.def(
      "length_unit",
      [](const std::string& name) { return std::string(symbol(length_unit_named(name))); },
      "name"_a);
  module.def("read_volume", &read_volume_as_array, "path"_a, "options"_a);
  module.def(
      "read_levels", [](const py::object& path) { return read_levels(path_of(path)); }, "path"_a);
  module.def("check", &check_mesh, "vertices"_a.noconvert(), "faces"_a.noconvert(),
             "self_intersections"_a, "volume"_a.none(true), "measure"_a, "threads"_a, "progress"_a);
  module.def("abandoned_work_count", &abandoned_work_count);
}
