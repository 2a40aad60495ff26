// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "complex/cell_members.h"
#include "complex/partition.h"
#include "core/slack_rows.h"
#include "error/cell_view.h"
#include "error/vertex_placement.h"
#include "isoatlas/mesh.h"

namespace isoatlas::detail {

/// CSR adjacency: the items of group g are items[first[g]] to items[first[g + 1] - 1].
struct CsrAdjacency {
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> items;
  std::span<const std::uint32_t> of(std::uint32_t group) const {
    return {items.data() + first[group], items.data() + first[group + 1]};
  }
};

/// @param for_each  called twice with a callable add(group, item); each group's items keep the
///                  order in which they are added
template <class ForEach>
CsrAdjacency make_csr_adjacency(std::uint32_t groups, ForEach for_each) {
  CsrAdjacency out;
  out.first.assign(groups + 1, 0);
  for_each([&](std::uint32_t group, std::uint32_t) { ++out.first[group]; });
  std::uint32_t total = 0;
  for (std::uint32_t& f : out.first) total += std::exchange(f, total);
  out.items.resize(total);
  for_each([&](std::uint32_t group, std::uint32_t item) { out.items[out.first[group]++] = item; });
  for (std::uint32_t g = groups; g > 0; --g)
    out.first[g] = out.first[g - 1];  // filling has moved each to its end
  out.first[0] = 0;
  return out;
}

/// The mesh of a certified partition, with what refinement needs of it. Points are metric.
struct LevelMesh {
  std::vector<Triangle> triangles;  ///< corners are cells
  std::vector<Vec3>
      triangle_normal;  ///< per triangle, unit, outward; zero for triangles without area
  SlackRows<std::uint32_t> triangles_of;  ///< per cell, the triangles with a corner there
  SlackRows<CVertexId> c_vertices_of;     ///< per cell, its c-vertices, increasing
  std::vector<Vec3> point;                ///< per cell, the point of its vertex
  std::vector<Vec3> normal;               ///< per cell, the surface's normal at its vertex

  std::uint32_t cell_count() const { return static_cast<std::uint32_t>(point.size()); }
  std::array<Vec3, 3> corners(std::uint32_t triangle) const {
    const Triangle& t = triangles[triangle];
    return {point[t[0]], point[t[1]], point[t[2]]};
  }
};

/// The corners of each triangle.
std::vector<Triangle> to_triangles(std::span<const DualTriangle> dual);

/// O(C)
LevelMesh make_level_mesh(const Surfels& surfels, const Partition& partition,
                          std::span<const DualTriangle> dual, const VertexPlacement& placement,
                          const RunControl* control = nullptr);

/// Adapts the mesh to another number of cells and to cells with other c-vertices; to be followed by
/// update_triangles().
/// @param changed  the cells whose c-vertices have changed
void update_cells(LevelMesh& mesh, const CellMembers& members, std::span<const CellId> changed);

/// Replaces the triangles and points of the mesh. Only differences are processed; everything else
/// is compared.
/// @param may_have_moved  the cells whose vertices may have moved, and all new cells; the other
///                        overload compares all cells
/// @return per cell, 1 if one of its triangles is new, was removed or has moved
std::vector<std::uint8_t> update_triangles(LevelMesh& mesh, const Surfels& surfels,
                                           std::span<const DualTriangle> dual,
                                           const VertexPlacement& placement,
                                           std::span<const CellId> may_have_moved,
                                           const RunControl* control = nullptr);
std::vector<std::uint8_t> update_triangles(LevelMesh& mesh, const Surfels& surfels,
                                           std::span<const DualTriangle> dual,
                                           const VertexPlacement& placement,
                                           const RunControl* control = nullptr);

/// Changes of a mesh: the ids of triangles with other corners and the cells whose vertices have
/// moved; sorted.
struct MeshEdit {
  std::vector<std::uint32_t> triangles;
  std::vector<CellId> vertices;
};

/// update_triangles() if only these changes were made.
void apply_edit(LevelMesh& mesh, const Surfels& surfels, std::span<const DualTriangle> triangles,
                const VertexPlacement& placement, const MeshEdit& edit,
                const RunControl* control = nullptr);

/// Updates the points of the vertices of `cells`, and the normals of their triangles.
void update_points(LevelMesh& mesh, const Surfels& surfels, std::span<const CellId> cells,
                   const VertexPlacement& placement, const RunControl* control = nullptr);

}  // namespace isoatlas::detail
