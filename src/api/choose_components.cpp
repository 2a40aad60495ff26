// SPDX-License-Identifier: Apache-2.0
#include "api/choose_components.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "complex/drop_components.h"
#include "core/ranges.h"
#include "core/vector_math.h"
#include "levels/level.h"

namespace isoatlas::detail {
namespace {

std::vector<RankedComponent> describe(const SurfaceComplex& complex, const Components& components,
                                      const ComponentSizes& sizes, const ExtractOptions& options,
                                      const Grid& grid) {
  const std::size_t n = components.topology.size();
  const double cubic_voxel = std::pow(grid.smallest_spacing(), 3);
  std::vector<RankedComponent> out(n);
  for (std::size_t c = 0; c < n; ++c) {
    out[c].size = sizes.enclosed[sizes.part_of[c]] * cubic_voxel;
    out[c].topology = components.topology[c];
  }
  TriangleMesh first;
  first.positions.resize(n);
  for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
    const ComponentId c = components.of_c_vertex[v];
    if (out[c].c_vertices++ == 0) first.positions[c] = complex.positions[v];
  }
  to_output_space(first, grid, options);
  for (std::size_t c = 0; c < n; ++c) out[c].position = first.positions[c];
  return out;
}

// Per part, whether one of the points is nearest to one of its components. Of several c-vertices at
// the same distance, the first counts.
// @param points  in the coordinates of the mesh
std::vector<std::uint8_t> parts_near(std::span<const Vec3> points, const TriangleMesh& c_vertices,
                                     const Components& components, const ComponentSizes& sizes) {
  std::vector<std::uint8_t> out(sizes.enclosed.size(), 0);
  for (const Vec3& point : points) {
    CVertexId nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (CVertexId v = 0; v < c_vertices.positions.size(); ++v) {
      const double squared = squared_length(c_vertices.positions[v] - point);
      if (squared < least) least = squared, nearest = v;
    }
    out[sizes.part_of[components.of_c_vertex[nearest]]] = 1;
  }
  return out;
}

// Per part, whether keep_near and drop_near exclude it.
std::vector<std::uint8_t> dropped_by_points(const SurfaceComplex& complex,
                                            const Components& components,
                                            const ComponentSizes& sizes,
                                            const ExtractOptions& options, const Grid& grid) {
  const ComponentChoice& choice = options.components;
  std::vector<std::uint8_t> out(sizes.enclosed.size(), 0);
  if (choice.keep_near.empty() && choice.drop_near.empty()) return out;
  TriangleMesh c_vertices;
  c_vertices.positions.assign(complex.positions.begin(), complex.positions.end());
  to_output_space(c_vertices, grid, options);
  const auto kept = parts_near(choice.keep_near, c_vertices, components, sizes);
  const auto dropped = parts_near(choice.drop_near, c_vertices, components, sizes);
  for (std::size_t part = 0; part < out.size(); ++part)
    out[part] = dropped[part] || (!choice.keep_near.empty() && !kept[part]) ? 1 : 0;
  return out;
}

}  // namespace

ChosenComponents choose_components(SurfaceComplex& complex, const Components& components,
                                   const ComponentSizes& sizes, const ExtractOptions& options,
                                   const Grid& grid) {
  std::vector<RankedComponent> all = describe(complex, components, sizes, options, grid);
  // Sorts by size and keeps the components of one part together. Parts of equal size are in the
  // scan order of their first components.
  std::vector<ComponentId> first_of_part(sizes.enclosed.size(), kNone);
  for (ComponentId c = static_cast<ComponentId>(all.size()); c-- > 0;)
    first_of_part[sizes.part_of[c]] = c;
  std::vector<ComponentId> order(all.size());
  for (ComponentId c = 0; c < order.size(); ++c) order[c] = c;
  ranges::sort(order, [&](ComponentId a, ComponentId b) {
    if (all[a].size != all[b].size) return all[a].size > all[b].size;
    const ComponentId first_a = first_of_part[sizes.part_of[a]],
                      first_b = first_of_part[sizes.part_of[b]];
    return first_a != first_b ? first_a < first_b : a < b;
  });

  const std::vector<std::uint8_t> is_excluded =
      dropped_by_points(complex, components, sizes, options, grid);
  ChosenComponents chosen;
  std::vector<std::uint8_t> is_dropped(all.size(), 0);
  std::size_t part = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const ComponentId c = order[i];
    part += i > 0 && sizes.part_of[order[i - 1]] != sizes.part_of[c] ? 1 : 0;
    all[c].part = part;
    const bool too_many =
        options.components.keep_largest > 0 && part >= options.components.keep_largest;
    is_dropped[c] =
        too_many || all[c].size < options.components.min_size || is_excluded[sizes.part_of[c]] != 0;
    (is_dropped[c] ? chosen.dropped : chosen.kept).push_back(all[c]);
  }
  drop_components(complex, components, is_dropped);
  chosen.is_dropped = std::move(is_dropped);
  return chosen;
}

}  // namespace isoatlas::detail
