// SPDX-License-Identifier: Apache-2.0
#include "error/level_mesh.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/cancel_poll.h"
#include "core/parallel.h"
#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kPerChunk = 2048;  // vertices or triangles, of a parallel loop

void set_normal(LevelMesh& mesh, std::uint32_t triangle) {
  const auto [a, b, c] = mesh.corners(triangle);
  mesh.triangle_normal[triangle] = normalized(cross(b - a, c - a));
}

// Updates the normals of these triangles, in any order; a triangle may be listed several times.
void set_normals(LevelMesh& mesh, std::vector<std::uint32_t> triangles) {
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  for_each_index(triangles.size(), kPerChunk,
                 [&](std::size_t i) { set_normal(mesh, triangles[i]); });
}

}  // namespace

std::vector<Triangle> to_triangles(std::span<const DualTriangle> dual) {
  std::vector<Triangle> out;
  out.reserve(dual.size());
  for (const DualTriangle& t : dual) out.push_back(t.cell);
  return out;
}

LevelMesh make_level_mesh(const Surfels& surfels, const Partition& partition,
                          std::span<const DualTriangle> dual, const VertexPlacement& placement,
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
  update_triangles(mesh, surfels, dual, placement, control);
  return mesh;
}

void update_cells(LevelMesh& mesh, const CellMembers& members, std::span<const CellId> changed) {
  mesh.c_vertices_of.resize_rows(members.cell_count());
  mesh.triangles_of.resize_rows(
      // rows of removed cells are kept until their triangles have been removed
      std::max(members.cell_count(), mesh.triangles_of.row_count()));
  std::vector<CVertexId> own;
  for (const CellId c : changed) {
    own.clear();
    members.for_each(c, [&](CVertexId v) { own.push_back(v); });
    std::sort(own.begin(), own.end());
    mesh.c_vertices_of.assign(c, own);
  }
}

std::vector<std::uint8_t> update_triangles(LevelMesh& mesh, const Surfels& surfels,
                                           std::span<const DualTriangle> dual,
                                           const VertexPlacement& placement,
                                           const RunControl* control) {
  std::vector<CellId> all(mesh.c_vertices_of.row_count());
  std::iota(all.begin(), all.end(), 0u);
  return update_triangles(mesh, surfels, dual, placement, all, control);
}

std::vector<std::uint8_t> update_triangles(LevelMesh& mesh, const Surfels& surfels,
                                           std::span<const DualTriangle> dual,
                                           const VertexPlacement& placement,
                                           std::span<const CellId> may_have_moved,
                                           const RunControl* control) {
  CancelPoll poll(control);
  const std::uint32_t cells = mesh.c_vertices_of.row_count();
  std::vector<std::uint8_t> changed_cells(mesh.triangles_of.row_count(), 0);
  const std::size_t old_count = mesh.point.size();
  mesh.point.resize(cells);
  mesh.normal.resize(cells);
  std::vector<std::uint32_t> changed_triangles;
  std::vector<Vec3> points(may_have_moved.size());
  for_each_index(points.size(), kPerChunk, control,
                 [&](std::size_t i) { points[i] = placement.point(surfels, may_have_moved[i]); });
  std::vector<CellId> moved_cells;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const CellId c = may_have_moved[i];
    mesh.normal[c] = surfels.normal[placement.anchor[c]];
    if (c < old_count && points[i] == mesh.point[c]) continue;
    poll.step();
    mesh.point[c] = points[i];
    moved_cells.push_back(c);
  }
  const auto mark_changed = [&](std::uint32_t t) {
    changed_triangles.push_back(t);
    for (const CellId c : mesh.triangles[t]) changed_cells[c] = 1;
  };
  const auto erase_from_rows = [&](std::uint32_t t) {
    for (const CellId c : mesh.triangles[t]) {
      mesh.triangles_of.erase(c, t);
      changed_cells[c] = 1;
    }
  };
  for (auto t = static_cast<std::uint32_t>(dual.size()); t < mesh.triangles.size(); ++t)
    erase_from_rows(t);
  const std::size_t before = std::min(mesh.triangles.size(), dual.size());
  mesh.triangles.resize(dual.size());
  mesh.triangle_normal.resize(dual.size());
  for (std::uint32_t t = 0; t < dual.size(); ++t) {
    const auto& cell = dual[t].cell;
    if (t < before) {
      if (mesh.triangles[t] == cell) continue;
      erase_from_rows(t);
    }
    poll.step();
    mesh.triangles[t] = cell;
    for (const CellId c : cell) mesh.triangles_of.push_back(c, t);
    mark_changed(t);
  }
  for (const CellId c : moved_cells) {
    poll.step();
    for (const std::uint32_t t : mesh.triangles_of.row(c)) mark_changed(t);
  }
  set_normals(mesh, std::move(changed_triangles));
  mesh.triangles_of.resize_rows(cells);
  changed_cells.resize(cells);
  return changed_cells;
}

void apply_edit(LevelMesh& mesh, const Surfels& surfels, std::span<const DualTriangle> triangles,
                const VertexPlacement& placement, const MeshEdit& edit, const RunControl* control) {
  CancelPoll poll(control);
  for (const CellId c : edit.vertices) {
    mesh.normal[c] = surfels.normal[placement.anchor[c]];
    mesh.point[c] = placement.point(surfels, c);
  }
  for (const std::uint32_t t : edit.triangles) {
    poll.step();
    for (const CellId c : mesh.triangles[t]) mesh.triangles_of.erase(c, t);
    mesh.triangles[t] = triangles[t].cell;
    for (const CellId c : triangles[t].cell) mesh.triangles_of.push_back(c, t);
    set_normal(mesh, t);
  }
  for (const CellId c : edit.vertices) {
    poll.step();
    for (const std::uint32_t t : mesh.triangles_of.row(c)) set_normal(mesh, t);
  }
}

void update_points(LevelMesh& mesh, const Surfels& surfels, std::span<const CellId> cells,
                   const VertexPlacement& placement, const RunControl* control) {
  CancelPoll poll(control);
  std::vector<std::uint32_t> triangles;
  for (const CellId c : cells) {
    poll.step();
    mesh.normal[c] = surfels.normal[placement.anchor[c]];
    mesh.point[c] = placement.point(surfels, c);
    const auto own = mesh.triangles_of.row(c);
    triangles.insert(triangles.end(), own.begin(), own.end());
  }
  set_normals(mesh, std::move(triangles));
}

}  // namespace isoatlas::detail
