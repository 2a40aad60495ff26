// SPDX-License-Identifier: Apache-2.0
#include "embedding/checked_cells.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/cancel_poll.h"
#include "core/parallel.h"
#include "core/vector_math.h"
#include "geometry/triangle_pair.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kCheckedGridCellsPerChunk = 64,
                      kCheckedFacesPerChunk = 8192;  // of parallel loops

bool any_intersect(std::span<const Triangle> triangles, std::span<const Vec3> positions) {
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t j = i + 1; j < triangles.size(); ++j) {
      if (intersect_beyond_shared_simplex(positions, triangles[i], triangles[j])) return true;
    }
  }
  return false;
}

}  // namespace

CheckedCells::CheckedCells(const SurfaceComplex& complex, std::span<const GridCell> grid_cells,
                           const RunControl& control)
    : complex_size_(complex.c_vertex_count()) {
  using Found = std::pair<std::uint32_t, Triangle>;
  const auto add = [&](Vec3 p, const Triangle& t, std::vector<Found>& found) {
    const GridCell grid_cell{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
    const auto at = std::lower_bound(grid_cells.begin(), grid_cells.end(), grid_cell);
    if (at == grid_cells.end() || *at != grid_cell) return;
    const auto c = static_cast<std::uint32_t>(at - grid_cells.begin());
    if (found.empty() || found.back() != std::pair(c, t)) found.emplace_back(c, t);
  };
  const auto is_inside = [](Vec3 p) {
    return p.x != std::floor(p.x) && p.y != std::floor(p.y) && p.z != std::floor(p.z);
  };
  const std::size_t faces = grid_cells.empty() ? 0 : complex.face_count();
  auto found = collect_chunks<Found>(
      faces, kCheckedFacesPerChunk,
      [&](std::size_t begin, std::size_t end, std::vector<Found>& out) {
        control.check_cancelled();
        for (const Face& face : std::span(complex.faces).subspan(begin, end - begin)) {
          if (!face.is_triangle()) continue;
          const Triangle t{face.corner[0], face.corner[1], face.corner[2]};
          bool any_inside = false;
          for (const CVertexId v : t) {
            if (!is_inside(complex.positions[v])) continue;
            add(complex.positions[v], t, out);
            any_inside = true;
          }
          if (!any_inside)
            add((1.0 / 3) *
                    (complex.positions[t[0]] + complex.positions[t[1]] + complex.positions[t[2]]),
                t, out);
        }
      });
  control.check_cancelled();
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  control.check_cancelled();
  found.erase(std::unique(found.begin(), found.end()), found.end());
  first_.assign(grid_cells.size() + 1, 0);
  first_grid_cell_.assign(complex_size_ + 1, 0);
  for (const auto& [grid_cell, t] : found) {
    ++first_[grid_cell + 1];
    triangles_.push_back(t);
    for (const CVertexId v : t) ++first_grid_cell_[v + 1];
  }
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  for (std::size_t v = 1; v < first_grid_cell_.size(); ++v)
    first_grid_cell_[v] += first_grid_cell_[v - 1];
  grid_cells_of_.resize(3 * found.size());
  std::vector<std::uint32_t> next(first_grid_cell_.begin(), first_grid_cell_.end() - 1);
  for (const auto& [grid_cell, t] : found) {
    for (const CVertexId v : t) grid_cells_of_[next[v]++] = grid_cell;
  }
}

std::vector<CVertexId> CheckedCells::intersecting(std::span<const CVertexId> moved,
                                                  std::span<const Vec3> positions,
                                                  const RunControl& control) const {
  std::vector<std::uint32_t> grid_cells;
  for (const CVertexId v : moved) {
    if (contains(v))
      grid_cells.insert(grid_cells.end(), grid_cells_of_.begin() + first_grid_cell_[v],
                        grid_cells_of_.begin() + first_grid_cell_[v + 1]);
  }
  std::sort(grid_cells.begin(), grid_cells.end());
  grid_cells.erase(std::unique(grid_cells.begin(), grid_cells.end()), grid_cells.end());
  std::vector<std::uint8_t> intersect(grid_cells.size(), 0);
  for_each_chunk(grid_cells.size(), kCheckedGridCellsPerChunk,
                 [&](std::size_t begin, std::size_t end) {
                   control.check_cancelled();
                   for (std::size_t i = begin; i < end; ++i)
                     intersect[i] = any_intersect(triangles(grid_cells[i]), positions);
                 });
  std::vector<CVertexId> out;
  for (std::size_t i = 0; i < grid_cells.size(); ++i) {
    if (!intersect[i]) continue;
    for (const Triangle& t : triangles(grid_cells[i])) out.insert(out.end(), t.begin(), t.end());
  }
  return out;
}

}  // namespace isoatlas::detail
