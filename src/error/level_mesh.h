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

/// Lists of items per group, one after the other: those of group g are [first[g], first[g + 1]).
struct Buckets {
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> items;
  std::span<const std::uint32_t> of(std::uint32_t group) const { return {items.data() + first[group], items.data() + first[group + 1]}; }
};

/// @param for_each  called twice with a callable add(group, item); each group's items stay in the order in which they are added
template <class ForEach>
Buckets make_buckets(std::uint32_t groups, ForEach for_each) {
  Buckets out;
  out.first.assign(groups + 1, 0);
  for_each([&](std::uint32_t group, std::uint32_t) { ++out.first[group]; });
  std::uint32_t total = 0;
  for (std::uint32_t& f : out.first) total += std::exchange(f, total);
  out.items.resize(total);
  for_each([&](std::uint32_t group, std::uint32_t item) { out.items[out.first[group]++] = item; });
  for (std::uint32_t g = groups; g > 0; --g) out.first[g] = out.first[g - 1];  // filling moved each to its end
  out.first[0] = 0;
  return out;
}

/// The mesh of a certified partition, with what refinement asks of it. Lengths have the spacing applied.
struct LevelMesh {
  std::vector<Triangle> triangles;        ///< by their cells
  std::vector<Vec3> triangle_normal;      ///< per triangle, unit, outward; zero for one without area
  SlackRows<std::uint32_t> triangles_of;  ///< per cell, the triangles with a corner there
  SlackRows<CVertexId> c_vertices_of;     ///< per cell, its c-vertices, increasing
  std::vector<Vec3> point;                ///< per cell, where its vertex sits
  std::vector<Vec3> normal;               ///< per cell, the surface's normal there

  std::uint32_t cell_count() const { return static_cast<std::uint32_t>(point.size()); }
  std::array<Vec3, 3> corners(std::uint32_t triangle) const {
    const Triangle& t = triangles[triangle];
    return {point[t[0]], point[t[1]], point[t[2]]};
  }
};

/// The corners of each.
std::vector<Triangle> cells_of(std::span<const DualTriangle> dual);

/// O(C)
LevelMesh make_level_mesh(const Surfels& surfels, const Partition& partition, std::span<const DualTriangle> dual,
                          const VertexPlacement& places, const RunControl* control = nullptr);

/// More or fewer cells, and other c-vertices of some; set_triangles() has to follow.
/// @param changed  the cells with other c-vertices than before
void set_cells(LevelMesh& mesh, const CellMembers& members, std::span<const CellId> changed);

/// Gives the mesh other triangles and places. Only those that are not what they were are worked on; the others are compared.
/// @param may_have_moved  the cells whose vertices may be elsewhere than in the mesh, and all new ones; the other form looks at all
/// @return per cell, 1 if a triangle there is new, gone or elsewhere
std::vector<std::uint8_t> set_triangles(LevelMesh& mesh, const Surfels& surfels, std::span<const DualTriangle> dual,
                                        const VertexPlacement& places, std::span<const CellId> may_have_moved,
                                        const RunControl* control = nullptr);
std::vector<std::uint8_t> set_triangles(LevelMesh& mesh, const Surfels& surfels, std::span<const DualTriangle> dual,
                                        const VertexPlacement& places, const RunControl* control = nullptr);

/// What was changed of a mesh: the numbers of triangles with other corners, and the cells whose vertices are elsewhere; sorted.
struct MeshEdit {
  std::vector<std::uint32_t> triangles;
  std::vector<CellId> vertices;
};

/// set_triangles() where only this has changed.
void edit_mesh(LevelMesh& mesh, const Surfels& surfels, std::span<const DualTriangle> triangles, const VertexPlacement& places,
               const MeshEdit& edit, const RunControl* control = nullptr);

/// Moves the vertices of `cells` and the corners of their triangles to their places.
void place(LevelMesh& mesh, const Surfels& surfels, std::span<const CellId> cells, const VertexPlacement& places,
           const RunControl* control = nullptr);

}  // namespace isoatlas::detail
