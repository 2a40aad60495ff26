// SPDX-License-Identifier: Apache-2.0
// The triangle shapes of marching cubes, for comparison.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "core/disjoint_sets.h"
#include "core/vector_math.h"
#include "field/to_space.h"
#include "page/marching_cubes_mesh.h"
#include "page/page.h"

namespace isoatlas::detail {
namespace {

// For each point the nearest vertex of the marching cubes surface (ties: the first one). It is
// nearly always in the grid cell of the point.
std::vector<std::uint32_t> nearest_vertices(std::span<const Vec3> vertices,
                                            std::span<const Vec3> points) {
  const auto cell_of = [](Vec3 p) {
    const auto below = [](double x) { return static_cast<std::int64_t>(std::floor(x)); };
    return std::array{below(p.x), below(p.y), below(p.z)};
  };
  std::map<std::array<std::int64_t, 3>, std::vector<std::size_t>> points_in;
  for (std::size_t i = 0; i < points.size(); ++i) points_in[cell_of(points[i])].push_back(i);
  std::vector<std::uint32_t> nearest(points.size(), 0);
  std::vector<double> distance(points.size(), std::numeric_limits<double>::infinity());
  const auto compare = [&](std::size_t i, std::uint32_t v) {
    const double d = length(vertices[v] - points[i]);
    if (d < distance[i]) distance[i] = d, nearest[i] = v;
  };
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    // Its own grid cell and those below it along any axes: a vertex is on an edge of up to four.
    for (unsigned k = 0; k < 8; ++k) {
      auto cell = cell_of(vertices[v]);
      for (std::size_t axis = 0; axis < 3; ++axis) cell[axis] -= k >> axis & 1U;
      const auto found = points_in.find(cell);
      if (found == points_in.end()) continue;
      for (const std::size_t i : found->second) compare(i, v);
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::uint32_t v = 0; distance[i] > 2 && v < vertices.size(); ++v) compare(i, v);
  }
  return nearest;
}

void keep_components_at(TriangleMesh& mesh, std::span<const Vec3> points, Vec3 spacing) {
  if (mesh.positions.empty()) return;
  DisjointSets sets(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    sets.unite(t[0], t[1]);
    sets.unite(t[1], t[2]);
  }
  std::vector<Vec3> index;
  for (const Vec3& p : mesh.positions)
    index.push_back({p.x / spacing.x, p.y / spacing.y, p.z / spacing.z});
  std::vector<std::uint8_t> is_kept(mesh.positions.size(), 0);
  for (const std::uint32_t v : nearest_vertices(index, points)) is_kept[sets.find(v)] = 1;
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return is_kept[sets.find(t[0])] == 0; });
}

}  // namespace

std::vector<Vec3> to_index(std::vector<Vec3> positions, const Grid& grid, Space space) {
  for (Vec3& p : positions) p = from_space(grid, space, p);
  return positions;
}

std::optional<MeshQuality> marching_cubes_quality(const VolumeView& volume, double isovalue,
                                                  std::span<const Vec3> of) {
  TriangleMesh mesh = page::marching_cubes_mesh(volume, isovalue);
  for (const Vec3& p : mesh.positions) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return std::nullopt;
  }
  if (!of.empty()) keep_components_at(mesh, of, volume.grid.spacing);
  if (mesh.triangles.empty()) return std::nullopt;
  return mesh_quality(mesh);
}

}  // namespace isoatlas::detail
