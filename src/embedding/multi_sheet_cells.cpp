// SPDX-License-Identifier: Apache-2.0
#include "embedding/multi_sheet_cells.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "core/cancel_poll.h"
#include "core/parallel.h"
#include "core/vector_math.h"
#include "embedding/grid_cell.h"
#include "geometry/triangle_pair.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kGridCellsPerChunk = 64, kCVerticesPerChunk = 16384;  // of parallel loops
// Coordinates in a grid cell: other positions are tried on this lattice. The number of initial
// placements.
constexpr std::array kLattice{kWallMargin, 0.1, 0.25, 0.5, 0.75, 0.9, 1 - kWallMargin};
constexpr int kAttempts = 12;
// Shares of the way from a c-vertex to the centre of the loop around its surfel, tried in order.
constexpr std::array kShares{0.25, 0.5, 0.75, 1.0};

bool is_in_grid_cell(Vec3 p) {
  return p.x != std::floor(p.x) && p.y != std::floor(p.y) && p.z != std::floor(p.z);
}

Vec3 inside(const GridCell& grid_cell, Vec3 p) {
  const auto clamp = [](double low, double x) {
    return std::clamp(x, low + kWallMargin, low + 1 - kWallMargin);
  };
  return {clamp(grid_cell[0], p.x), clamp(grid_cell[1], p.y), clamp(grid_cell[2], p.z)};
}

// Parsing gives the c-vertices of a grid cell consecutive ids.
bool are_in_same_grid_cell(const SurfaceComplex& complex, CVertexId a, CVertexId b) {
  const Vec3 p = complex.positions[a], q = complex.positions[b];
  return is_in_grid_cell(p) && is_in_grid_cell(q) && grid_cell_of(p) == grid_cell_of(q);
}
bool is_multi_sheet(const SurfaceComplex& complex, CVertexId v) {
  return (v > 0 && are_in_same_grid_cell(complex, v - 1, v)) ||
         (v + 1 < complex.c_vertex_count() && are_in_same_grid_cell(complex, v, v + 1));
}

}  // namespace

MultiSheetCells::MultiSheetCells(const SurfaceComplex& complex, const InterpolatedField& field,
                                 const RunControl& control) {
  const std::uint32_t n = complex.c_vertex_count();
  grid_cell_of_.assign(n, kNone);
  c_vertices_ = collect_chunks<CVertexId>(
      n, kCVerticesPerChunk, [&](std::size_t begin, std::size_t end, auto& found) {
        control.check_cancelled();
        for (auto v = static_cast<CVertexId>(begin); v < end; ++v) {
          if (is_multi_sheet(complex, v)) found.push_back(v);
        }
      });
  control.check_cancelled();
  for (std::uint32_t i = 0; i < c_vertices_.size(); ++i) {
    if (i == 0 || !are_in_same_grid_cell(complex, c_vertices_[i - 1], c_vertices_[i]))
      first_.push_back(i);
    grid_cell_of_[c_vertices_[i]] = static_cast<std::uint32_t>(first_.size() - 1);
  }
  if (c_vertices_.empty()) return;
  first_.push_back(static_cast<std::uint32_t>(c_vertices_.size()));

  // The faces around these c-vertices as pieces of surfels, by grid cell.
  flags_.assign(n, 0);
  for (const CVertexId v : c_vertices_) flags_[v] = 1;
  const SurfaceInGrid in{field, flags_, &control};
  const std::vector<Fineness> current = fineness(complex, in);
  ComplexPart part(complex, c_vertices_, current, flags_, &control);
  std::erase_if(part.wanted, [&](CVertexId v) { return part.fineness[v] != Fineness::faces; });
  const Subdivision subdivision = part.subdivided(in);
  const auto number = [&](CVertexId v) {
    return v < part.c_vertex.size() ? part.c_vertex[v] : kNone;
  };
  CancelPoll poll(control);
  std::vector<std::pair<std::uint32_t, Triangle>> pieces;
  for (const Face& face : subdivision.complex.faces) {
    poll.step();
    if (!face.is_triangle()) continue;
    const auto own = std::find_if(face.corner.begin(), face.corner.begin() + 3,
                                  [&](CVertexId v) { return contains(number(v)); });
    if (own != face.corner.begin() + 3)
      pieces.emplace_back(grid_cell_of_[number(*own)],
                          Triangle{face.corner[0], face.corner[1], face.corner[2]});
  }
  control.check_cancelled();
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  control.check_cancelled();
  // per corner of the pieces of the last grid cell, its index there
  std::vector<std::uint32_t> index_in_grid_cell(subdivision.complex.c_vertex_count(), kNone);
  std::vector<std::uint32_t> grid_cell_of_index(index_in_grid_cell.size(), kNone);
  std::vector<CVertexId> number_in_part(n, kNone);
  for (CVertexId v = 0; v < part.c_vertex.size(); ++v) number_in_part[part.c_vertex[v]] = v;
  auto piece = pieces.begin();
  first_piece_.push_back(0);
  first_wall_position_.push_back(0);
  for (std::uint32_t grid_cell = 0; grid_cell + 1 < first_.size(); ++grid_cell) {
    poll.step();
    std::uint32_t corners = 0;
    const auto add = [&](CVertexId v) {
      grid_cell_of_index[v] = grid_cell;
      index_in_grid_cell[v] = corners++;
    };
    for (const CVertexId v : c_vertices(grid_cell)) add(number_in_part[v]);
    for (; piece != pieces.end() && piece->first == grid_cell; ++piece) {
      Triangle& t = pieces_.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const CVertexId v = piece->second[k];
        if (grid_cell_of_index[v] != grid_cell) {
          add(v);
          wall_positions_.push_back(subdivision.complex.positions[v]);
        }
        t[k] = index_in_grid_cell[v];
      }
    }
    first_piece_.push_back(static_cast<std::uint32_t>(pieces_.size()));
    first_wall_position_.push_back(static_cast<std::uint32_t>(wall_positions_.size()));
  }
}

// The surfels of one multi-sheet grid cell as triangles. Its c-vertices come first.
class MultiSheetCells::Surfels {
 public:
  Surfels(const MultiSheetCells& in, std::uint32_t grid_cell)
      : corners(in.c_vertices(grid_cell).size()), triangles(in.pieces(grid_cell)) {
    corners.insert(corners.end(), in.wall_positions(grid_cell).begin(),
                   in.wall_positions(grid_cell).end());
  }

  /// Number of intersecting pairs of triangles, at most `max_count`.
  std::size_t count_intersecting_pairs(std::size_t max_count) const {
    return isoatlas::detail::count_intersecting_pairs(corners, triangles, max_count);
  }
  bool intersect() const { return count_intersecting_pairs(1) > 0; }

  std::vector<Vec3> corners;
  std::span<const Triangle> triangles;
};

bool MultiSheetCells::surfels_intersect(std::uint32_t grid_cell,
                                        std::span<const Vec3> positions) const {
  Surfels surfels(*this, grid_cell);
  const std::span<const CVertexId> own = c_vertices(grid_cell);
  for (std::size_t k = 0; k < own.size(); ++k) surfels.corners[k] = positions[own[k]];
  return surfels.intersect();
}

// Moves one c-vertex after the other to the lattice position with the fewest intersecting pairs
// (ties: nearest to its start), until no pair intersects. If no move reduces the number of pairs,
// starts again from other positions. @return whether positions without intersections were found
bool MultiSheetCells::search_positions(std::uint32_t grid_cell, std::span<Vec3> positions,
                                       const RunControl& control) const {
  Surfels surfels(*this, grid_cell);
  const GridCell low = grid_cell_of(positions[0]);
  const std::vector<Vec3> start(positions.begin(), positions.end());
  const auto lattice = [&](std::size_t i, std::size_t j, std::size_t k) {
    return rounded({low[0] + kLattice[i], low[1] + kLattice[j], low[2] + kLattice[k]});
  };
  std::uint64_t state = 1;
  const auto any = [&] {  // a pseudo-random lattice position, the same sequence every time
    state = state * 6364136223846793005u + 1442695040888963407u;
    const std::uint64_t r = state >> 33;
    return lattice(r % kLattice.size(), r / kLattice.size() % kLattice.size(),
                   r / kLattice.size() / kLattice.size() % kLattice.size());
  };
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    for (std::size_t v = 0; v < positions.size(); ++v)
      surfels.corners[v] = attempt == 0 ? start[v] : any();
    control.check_cancelled();
    std::size_t fewest_pairs = surfels.count_intersecting_pairs(kNone);
    for (bool improved = true; improved && fewest_pairs > 0;) {
      improved = false;
      for (std::size_t v = 0; v < positions.size() && fewest_pairs > 0; ++v) {
        Vec3 best = surfels.corners[v];
        double nearest = INFINITY;
        std::size_t fewest = fewest_pairs;
        for (std::size_t i = 0; i < kLattice.size(); ++i) {
          for (std::size_t j = 0; j < kLattice.size(); ++j) {
            for (std::size_t k = 0; k < kLattice.size(); ++k) {
              surfels.corners[v] = lattice(i, j, k);
              const double away = squared_length(surfels.corners[v] - start[v]);
              const std::size_t pairs = surfels.count_intersecting_pairs(fewest + 1);
              if (pairs > fewest || (pairs == fewest && (pairs == fewest_pairs || away >= nearest)))
                continue;
              fewest = pairs;
              nearest = away;
              best = surfels.corners[v];
            }
          }
        }
        surfels.corners[v] = best;
        improved = improved || fewest < fewest_pairs;
        fewest_pairs = fewest;
      }
    }
    if (fewest_pairs > 0) continue;
    std::copy(surfels.corners.begin(),
              surfels.corners.begin() + static_cast<std::ptrdiff_t>(positions.size()),
              positions.begin());
    return true;
  }
  return false;
}

// Per c-vertex of the grid cell, the mean of the points around it.
std::vector<Vec3> MultiSheetCells::centres(std::uint32_t grid_cell) const {
  std::vector<Vec3> out;
  const auto n = static_cast<std::uint32_t>(c_vertices(grid_cell).size());
  for (std::uint32_t own = 0; own < n; ++own) {
    Vec3 sum;
    std::size_t count = 0;
    for (const Triangle& t : pieces(grid_cell)) {
      if (std::find(t.begin(), t.end(), own) == t.end()) continue;
      for (const std::uint32_t at : t) {
        if (at < n) continue;
        sum = sum + wall_positions(grid_cell)[at - n];
        ++count;
      }
    }
    out.push_back((1.0 / static_cast<double>(std::max<std::size_t>(1, count))) * sum);
  }
  return out;
}

std::size_t MultiSheetCells::separate(SurfaceComplex& complex, const RunControl& control) {
  if (first_.empty()) return 0;
  std::atomic<std::size_t> left = 0;
  for_each_chunk(first_.size() - 1, kGridCellsPerChunk, [&](std::size_t begin, std::size_t end) {
    for (auto grid_cell = static_cast<std::uint32_t>(begin); grid_cell < end; ++grid_cell) {
      control.check_cancelled();
      const std::span<const CVertexId> own = c_vertices(grid_cell);
      std::vector<Vec3> start;
      for (const CVertexId v : own) start.push_back(complex.positions[v]);
      const auto are_separated_by = [&](auto position_of) {
        for (std::size_t k = 0; k < own.size(); ++k) complex.positions[own[k]] = position_of(k);
        return !surfels_intersect(grid_cell, complex.positions);
      };
      const auto away_from_walls = [&](std::size_t k, Vec3 p) {
        return rounded(inside(grid_cell_of(start[k]), p));
      };
      if (are_separated_by([&](std::size_t k) { return away_from_walls(k, start[k]); }) ||
          are_separated_by([&](std::size_t k) { return start[k]; }))
        continue;
      const std::vector<Vec3> centre = centres(grid_cell);
      bool separated = false;
      for (std::size_t i = 0; i < kShares.size() && !separated; ++i)
        separated = are_separated_by([&](std::size_t k) {
          return away_from_walls(k, start[k] + kShares[i] * (centre[k] - start[k]));
        });
      if (!separated) {
        separated = search_positions(grid_cell, start, control);
        for (std::size_t k = 0; k < own.size(); ++k) complex.positions[own[k]] = start[k];
      }
      left += !separated;
    }
  });
  return left;
}

std::vector<CVertexId> MultiSheetCells::intersecting(std::span<const CVertexId> moved,
                                                     std::span<const Vec3> positions,
                                                     const RunControl& control) const {
  std::vector<std::uint32_t> grid_cells;
  for (const CVertexId v : moved) {
    if (contains(v)) grid_cells.push_back(grid_cell_of_[v]);
  }
  std::sort(grid_cells.begin(), grid_cells.end());
  grid_cells.erase(std::unique(grid_cells.begin(), grid_cells.end()), grid_cells.end());
  return collect_chunks<CVertexId>(
      grid_cells.size(), kGridCellsPerChunk, [&](std::size_t begin, std::size_t end, auto& out) {
        control.check_cancelled();
        for (std::size_t i = begin; i < end; ++i) {
          if (!surfels_intersect(grid_cells[i], positions)) continue;
          const std::span<const CVertexId> own = c_vertices(grid_cells[i]);
          out.insert(out.end(), own.begin(), own.end());
        }
      });
}

}  // namespace isoatlas::detail
