// SPDX-License-Identifier: Apache-2.0
#include "check.h"

#include <memory>
#include <stdexcept>
#include <utility>

#include "interruptible.h"
#include "isoatlas/error.h"
#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "report/report.h"
#include "wording/settings.h"

namespace isoatlas::detail::python {
namespace {

/// A C-contiguous n x 3 array as a list of its rows.
template <class Item, class Array>
std::vector<Item> rows_of(const Array& array) {
  if (array.ndim() != 2 || array.shape(1) != 3)
    throw std::invalid_argument("the array is not n x 3");
  std::vector<Item> rows;
  rows.reserve(static_cast<std::size_t>(array.shape(0)));
  for (auto [row, i] = std::pair(array.data(), py::ssize_t{0}); i < array.shape(0); ++i, row += 3)
    rows.push_back({row[0], row[1], row[2]});
  return rows;
}

}  // namespace

std::string check_mesh(const py::array_t<double, py::array::c_style>& vertices,
                       const py::array_t<std::uint32_t, py::array::c_style>& faces,
                       bool self_intersections, const std::optional<ArrayVolume>& volume,
                       const Words& measure, int threads, const py::object& progress) {
  const auto mesh = std::make_shared<TriangleMesh>();
  mesh->positions = rows_of<Vec3>(vertices);
  mesh->triangles = rows_of<Triangle>(faces);
  DistanceReport distance;
  for (const auto& [name, text] : measure) {
    try {
      set(distance.options, name, text);
    } catch (const Error& error) {
      throw Error(error.code(), name + ": " + error.what());
    }
  }
  VolumeView view;
  std::optional<Axes> axes;
  if (volume) {
    view = volume->view();
    axes = volume->axes;
    if (distance.options.space == Space::ras && !volume->is_xyz)
      throw Error(ErrorCode::bad_argument,
                  "space: ras needs the coordinates x, y, z, expected order='xyz' with it");
    distance.volume_path = volume->path;
  }
  const auto work = [mesh, self_intersections, view, axes,
                     requested = distance](const RunControl& control) {
    const MeshTopology topology = mesh_topology(*mesh);
    const MeshExtent extent = summarize(component_extents(*mesh, topology), kCheckedComponents);
    const MeshQuality quality = mesh_quality(*mesh);
    control.check_cancelled();
    std::optional<SelfIntersectionReport> intersections;
    if (self_intersections) intersections = find_self_intersections(*mesh, control);
    DistanceReport found = requested;
    if (axes) {
      const Space space = found.options.space;
      MeasureOptions options = found.options;
      options.space = axes->space_in_library(space);
      axes->to_library(*mesh, space);
      try {
        found.measured = isoatlas::measure(*mesh, view, options, control);
      } catch (const Error& error) {
        throw found.volume_path.empty() ? error : error.with_prefix(found.volume_path + ": ");
      }
      axes->to_caller(found.measured, space);
    }
    return to_json("", topology, extent, quality, intersections ? &*intersections : nullptr,
                   axes ? &found : nullptr);
  };
  return compute_interruptibly(work,
                               {.progress = progress,
                                .threads = threads,
                                .keep_alive = volume ? py::object(volume->array) : py::none()});
}

}  // namespace isoatlas::detail::python
