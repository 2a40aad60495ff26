// SPDX-License-Identifier: Apache-2.0
#include <new>
#include <vector>

#include "core/parallel.h"
#include "core/vector_math.h"
#include "field/check_volume.h"
#include "field/dense_volume.h"
#include "field/interpolated_field.h"
#include "field/to_space.h"
#include "geometry/bounds.h"
#include "geometry/require_corners.h"
#include "geometry/vertex_normals.h"
#include "isoatlas/error.h"
#include "isoatlas/normals.h"

namespace isoatlas {
using namespace detail;
namespace {

constexpr std::size_t kVerticesPerChunk = 1024;

}  // namespace

std::vector<Vec3> vertex_normals(const MeshView& mesh) try {
  require_corners(mesh);
  const double size = mesh.positions.empty() ? 0 : bounds_of(mesh.positions).longest();
  return detail::vertex_normals(mesh, size > 0 ? size : 1);
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory for these normals");
}

std::vector<Vec3> vertex_normals(const MeshView& mesh, const VolumeView& any_volume,
                                 const SurfaceOptions& surface, Space space,
                                 const RunControl& control) try {
  std::vector<Vec3> out = vertex_normals(mesh);
  check_volume(any_volume, surface.isovalue);
  const Volume kept = dense_volume(any_volume);
  const Grid& grid = kept.view.grid;
  const InterpolatedField field(kept.view, {surface.isovalue, surface.inside, surface.non_finite},
                                surface.interpolation);
  const ThreadLimit threads(control.threads);
  const double flip = space == Space::ras ? -1 : 1;
  const Vec3 last = field.last();
  const auto is_inside = [](double x, double most) { return x >= -1e-6 && x <= most + 1e-6; };
  for_each_index(mesh.positions.size(), kVerticesPerChunk, &control, [&](std::size_t v) {
    const Vec3 index = from_space(grid, space, mesh.positions[v]);
    if (!is_inside(index.x, last.x) || !is_inside(index.y, last.y) || !is_inside(index.z, last.z))
      return;
    const Vec3 slope = field.at(index).gradient;  // grows inwards
    Vec3 normal{-slope.x, -slope.y, -slope.z};
    if (space != Space::voxel) {
      const Vec3 along{normal.x / grid.spacing.x, normal.y / grid.spacing.y,
                       normal.z / grid.spacing.z};
      const Vec3 world =
          along.x * grid.direction[0] + along.y * grid.direction[1] + along.z * grid.direction[2];
      normal = {flip * world.x, flip * world.y, world.z};
    }
    if (const Vec3 unit = normalized(normal); !(unit == Vec3{})) out[v] = unit;
  });
  return out;
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory for these normals");
}

std::vector<Vec3> vertex_normals(const MeshView& mesh, const ScalarField& field,
                                 Inside inside) try {
  if (!field.gradient) throw Error(ErrorCode::bad_argument, "the field has no gradient");
  std::vector<Vec3> out = vertex_normals(mesh);
  const double outward = inside == Inside::above ? -1 : 1;
  for_each_index(mesh.positions.size(), kVerticesPerChunk, [&](std::size_t v) {
    if (const Vec3 unit = normalized(outward * field.gradient(mesh.positions[v]));
        !(unit == Vec3{}))
      out[v] = unit;
  });
  return out;
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory for these normals");
}

}  // namespace isoatlas
