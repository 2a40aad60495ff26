// SPDX-License-Identifier: Apache-2.0
#include "refine/level_mesh.h"

#include "core/vector_math.h"
#include "subdivide/subdivide.h"

namespace isoatlas {
namespace {

void set_corners(MeshTriangle& t, const std::vector<Vec3>& point) {
  for (std::size_t k = 0; k < 3; ++k) t.corner[k] = point[t.cell[k]];
  t.normal = normalized(cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]));
}

}  // namespace

Vec3 base_position(const SurfaceComplex& complex, const Places& places, CellId c) {
  return displaced(complex, places.anchor[c], places.shift.empty() ? Vec3{} : places.shift[c]);
}

std::vector<Vec3> vertex_positions(const SurfaceComplex& complex, const Surfels& surfels, const Places& places) {
  const Vec3 s = complex.spacing;
  std::vector<Vec3> out;
  out.reserve(places.anchor.size());
  for (CellId c = 0; c < places.anchor.size(); ++c) {
    Vec3 p = base_position(complex, places, c);
    if (!places.offset.empty()) {
      const Vec3 n = surfels.normal[places.anchor[c]];
      const auto d = static_cast<double>(places.offset[c]);
      p = p + Vec3{d * n.x / s.x, d * n.y / s.y, d * n.z / s.z};
    }
    out.push_back(p);
  }
  return out;
}

std::vector<Triangle> cells_of(std::span<const DualTriangle> dual) {
  std::vector<Triangle> out;
  out.reserve(dual.size());
  for (const DualTriangle& t : dual) out.push_back(t.cell);
  return out;
}

LevelMesh make_level_mesh(const Surfels& surfels, const Partition& partition, std::span<const DualTriangle> dual, const Places& places) {
  LevelMesh mesh;
  const std::uint32_t cells = partition.cell_count();
  mesh.c_vertices_of = make_buckets(cells, [&](auto add) {
    for (CVertexId v = 0; v < partition.cell_of.size(); ++v) add(partition.cell_of[v], v);
  });
  mesh.point.resize(cells);
  mesh.normal.resize(cells);
  set_triangles(mesh, surfels, dual, places);
  return mesh;
}

void set_triangles(LevelMesh& mesh, const Surfels& surfels, std::span<const DualTriangle> dual, const Places& places) {
  for (CellId c = 0; c < mesh.cell_count(); ++c) {
    mesh.normal[c] = surfels.normal[places.anchor[c]];
    mesh.point[c] = places.point(surfels, c);
  }
  mesh.triangles.resize(dual.size());
  for (std::size_t i = 0; i < dual.size(); ++i) {
    mesh.triangles[i].cell = dual[i].cell;
    set_corners(mesh.triangles[i], mesh.point);
  }
  mesh.triangles_of = make_buckets(mesh.cell_count(), [&](auto add) {
    for (std::uint32_t i = 0; i < dual.size(); ++i) {
      for (const CellId c : dual[i].cell) add(c, i);
    }
  });
}

void place(LevelMesh& mesh, const Surfels& surfels, std::span<const CellId> cells, const Places& places) {
  for (const CellId c : cells) {
    mesh.normal[c] = surfels.normal[places.anchor[c]];
    mesh.point[c] = places.point(surfels, c);
  }
  for (const CellId c : cells) {
    for (const std::uint32_t t : mesh.triangles_of.of(c)) set_corners(mesh.triangles[t], mesh.point);
  }
}

}  // namespace isoatlas
