// SPDX-License-Identifier: Apache-2.0
#include "refine/level_mesh.h"

#include <algorithm>
#include <numeric>

#include "core/cancel_poll.h"
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

LevelMesh make_level_mesh(const Surfels& surfels, const Partition& partition, std::span<const DualTriangle> dual, const Places& places,
                          const RunControl* control) {
  CancelPoll poll(control);
  LevelMesh mesh;
  const std::uint32_t cells = partition.cell_count();
  std::vector<std::uint32_t> count(cells, 0);
  for (const CellId c : partition.cell_of) ++count[c];
  mesh.c_vertices_of.reserve(count);
  for (CVertexId v = 0; v < partition.cell_of.size(); ++v) {
    poll.step();
    mesh.c_vertices_of.push_back(partition.cell_of[v], v);
  }
  std::fill(count.begin(), count.end(), 0u);
  for (const DualTriangle& t : dual) {
    poll.step();
    for (const CellId c : t.cell) ++count[c];
  }
  mesh.triangles_of.reserve(count);
  set_triangles(mesh, surfels, dual, places, control);
  return mesh;
}

void set_cells(LevelMesh& mesh, const CellMembers& members, std::span<const CellId> changed) {
  mesh.c_vertices_of.add_rows(members.cell_count() - mesh.c_vertices_of.row_count());
  mesh.triangles_of.add_rows(members.cell_count() - mesh.triangles_of.row_count());
  std::vector<CVertexId> own;
  for (const CellId c : changed) {
    own.clear();
    members.for_each(c, [&](CVertexId v) { own.push_back(v); });
    std::sort(own.begin(), own.end());
    mesh.c_vertices_of.assign(c, own);
  }
}

std::vector<std::uint8_t> set_triangles(LevelMesh& mesh, const Surfels& surfels, std::span<const DualTriangle> dual, const Places& places,
                                        const RunControl* control) {
  std::vector<CellId> all(mesh.c_vertices_of.row_count());
  std::iota(all.begin(), all.end(), 0u);
  return set_triangles(mesh, surfels, dual, places, all, control);
}

std::vector<std::uint8_t> set_triangles(LevelMesh& mesh, const Surfels& surfels, std::span<const DualTriangle> dual, const Places& places,
                                        std::span<const CellId> may_have_moved, const RunControl* control) {
  CancelPoll poll(control);
  const std::uint32_t cells = mesh.c_vertices_of.row_count();
  std::vector<std::uint8_t> renewed(cells, 0);
  std::vector<CellId> moved;
  const std::size_t known = mesh.point.size();
  mesh.point.resize(cells);
  mesh.normal.resize(cells);
  for (const CellId c : may_have_moved) {
    const Vec3 point = places.point(surfels, c);
    mesh.normal[c] = surfels.normal[places.anchor[c]];
    if (c < known && point == mesh.point[c]) continue;
    poll.step();
    mesh.point[c] = point;
    moved.push_back(c);
  }
  const auto renew = [&](std::uint32_t t) {
    set_corners(mesh.triangles[t], mesh.point);
    for (const CellId c : mesh.triangles[t].cell) renewed[c] = 1;
  };
  const auto leave_rows = [&](std::uint32_t t) {
    for (const CellId c : mesh.cells_of_triangle[t]) {
      mesh.triangles_of.erase(c, t);
      renewed[c] = 1;
    }
  };
  for (auto t = static_cast<std::uint32_t>(dual.size()); t < mesh.triangles.size(); ++t) leave_rows(t);
  const std::size_t before = std::min(mesh.triangles.size(), dual.size());
  mesh.triangles.resize(dual.size());
  mesh.cells_of_triangle.resize(dual.size());
  for (std::uint32_t t = 0; t < dual.size(); ++t) {
    const auto& cell = dual[t].cell;
    if (t < before) {
      if (mesh.cells_of_triangle[t] == cell) continue;
      leave_rows(t);
    }
    poll.step();
    mesh.triangles[t].cell = mesh.cells_of_triangle[t] = cell;
    for (const CellId c : cell) mesh.triangles_of.push_back(c, t);
    renew(t);
  }
  for (const CellId c : moved) {
    poll.step();
    for (const std::uint32_t t : mesh.triangles_of.row(c)) renew(t);
  }
  return renewed;
}

void place(LevelMesh& mesh, const Surfels& surfels, std::span<const CellId> cells, const Places& places, const RunControl* control) {
  CancelPoll poll(control);
  for (const CellId c : cells) {
    mesh.normal[c] = surfels.normal[places.anchor[c]];
    mesh.point[c] = places.point(surfels, c);
  }
  for (const CellId c : cells) {
    poll.step();
    for (const std::uint32_t t : mesh.triangles_of.row(c)) set_corners(mesh.triangles[t], mesh.point);
  }
}

}  // namespace isoatlas
