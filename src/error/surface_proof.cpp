// SPDX-License-Identifier: Apache-2.0
#include "error/surface_proof.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/cancel_poll.h"
#include "core/ranges.h"
#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "error/clipped_box.h"
#include "error/two_ring.h"
#include "geometry/closest_point.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kProvedCellsPerChunk = 16;

class GridCellSearch {
 public:
  GridCellSearch(const MeasuredSurface& surface, const GridCellIndex& grid_cell_index,
                 const LevelMesh& mesh, std::span<const CellId> cell_of, double bound)
      : surface_(surface),
        grid_cell_index_(grid_cell_index),
        mesh_(mesh),
        cell_of_(cell_of),
        bound_(bound),
        ring_(mesh) {}

  Farthest search(CellId cell) {
    ring_.set_cell(cell);
    cell_ = cell;
    farthest_ = {};
    keys_.clear();
    for (const CVertexId v : mesh_.c_vertices_of.row(cell)) {
      grid_cell_index_.for_each_at(v, [&](GridCellIndex::Key key) { keys_.push_back(key); });
    }
    ranges::sort(keys_);
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
    for (std::size_t i = 0; i < keys_.size() && farthest_.at == kNone; ++i)
      search_grid_cell(keys_[i]);
    return farthest_;
  }

 private:
  // Searches one grid cell until it finds a part that is too far away.
  void search_grid_cell(GridCellIndex::Key key) {
    const Vec3 low = grid_cell_index_.low(key);
    const auto field = surface_.isosurface->field().cell(low);
    if (!field) {
      farthest_ = {INFINITY, mesh_.c_vertices_of.row(cell_)[0]};
      return;
    }
    boxes_.assign(1, {{}, 1});
    while (!boxes_.empty()) {
      const GridCellBox box = boxes_.back();
      boxes_.pop_back();
      if (!clipped_.cut(*field, box)) continue;
      clipped_.convert_to_metric(low, surface_.spacing);
      const Vec3 centre = clipped_.centre();
      if (farthest_from(ring_.closest(centre, 0.5 * bound_).first) <= bound_) continue;
      const auto [triangle, point] = ring_.closest(centre);
      const double far = farthest_from(triangle),
                   near = std::sqrt(point.squared_distance) - clipped_.radius(centre);
      if (far <= bound_) continue;
      // Other sheets in the grid cell are proved with the cells of their nearest c-vertices.
      if (belongs_to_others(key)) continue;
      const CVertexId nearest = nearest_c_vertex(key, centre);
      const bool is_own = cell_of_[nearest] == cell_;
      if (box.size > kMinBoxSize && (near <= bound_ || !is_own)) {
        for (std::size_t k = 0; k < 8; ++k) boxes_.push_back(box.part(k));
        continue;
      }
      if (!is_own) continue;
      farthest_ = {static_cast<float>(near > bound_ ? near : far), nearest};
      return;
    }
  }

  double farthest_from(std::uint32_t triangle) const {
    const auto [a, b, c] = mesh_.corners(triangle);
    double squared = 0;
    for (const Vec3& p : clipped_.corners()) {
      squared = std::max(squared, closest_on_triangle(p, a, b, c).squared_distance);
    }
    return std::sqrt(squared);
  }

  // Whether for all points of the box some c-vertex of another cell is nearer than any of this
  // cell. The box is on one side of the plane between two c-vertices if its corners are.
  bool belongs_to_others(GridCellIndex::Key key) const {
    const std::span<const CVertexId> c_vertices = grid_cell_index_.c_vertices(key);
    const auto is_nearer = [&](CVertexId a, CVertexId b) {
      const Vec3 p = surface_.surfels.point[a], q = surface_.surfels.point[b];
      return ranges::all_of(clipped_.corners(),
                            [&](Vec3 x) { return squared_length(x - p) < squared_length(x - q); });
    };
    return ranges::all_of(c_vertices, [&](CVertexId own) {
      return cell_of_[own] != cell_ || ranges::any_of(c_vertices, [&](CVertexId other) {
               return cell_of_[other] != cell_ && is_nearer(other, own);
             });
    });
  }

  CVertexId nearest_c_vertex(GridCellIndex::Key key, Vec3 p) const {
    CVertexId nearest = kNone;
    double squared = INFINITY;
    for (const CVertexId v : grid_cell_index_.c_vertices(key)) {
      const double d = squared_length(surface_.surfels.point[v] - p);
      if (d < squared) squared = d, nearest = v;
    }
    return nearest;
  }

  const MeasuredSurface& surface_;
  const GridCellIndex& grid_cell_index_;
  const LevelMesh& mesh_;
  std::span<const CellId> cell_of_;
  double bound_;
  TwoRing ring_;
  CellId cell_ = 0;
  Farthest farthest_;
  std::vector<GridCellIndex::Key> keys_;
  std::vector<GridCellBox> boxes_;
  ClippedBox clipped_;
};

}  // namespace

GridCellIndex::GridCellIndex(const SurfaceComplex& complex, Vec3 last, const RunControl* control)
    : complex_(complex),
      size_x_(static_cast<Key>(last.x)),
      size_y_(static_cast<Key>(last.y)),
      size_z_(static_cast<Key>(last.z)) {
  std::vector<std::pair<Key, CVertexId>> all;
  all.reserve(complex.c_vertex_count());
  CancelPoll poll(control);
  for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
    poll.step();
    for_each_at(v, [&](Key key) { all.emplace_back(key, v); });
  }
  ranges::sort(all);
  keys_.reserve(all.size());
  items_.reserve(all.size());
  for (const auto& [key, v] : all) {
    poll.step();
    keys_.push_back(key);
    items_.push_back(v);
  }
}

template <class Visit>
void GridCellIndex::visit_cells(Vec3 p, Visit visit) const {
  // Along an axis: the last grid cell that contains the coordinate, and the previous one if it is
  // on the wall between them.
  const auto cells = [](double x, Key size) {
    const double clamped = std::clamp(x, 0.0, static_cast<double>(size));
    const auto last = std::min(static_cast<Key>(clamped), size - 1);
    const bool on_wall = clamped == static_cast<double>(last) && last > 0;
    return std::pair(on_wall ? last - 1 : last, last);
  };
  const auto [x0, x1] = cells(p.x, size_x_);
  const auto [y0, y1] = cells(p.y, size_y_);
  const auto [z0, z1] = cells(p.z, size_z_);
  for (Key z = z0; z <= z1; ++z) {
    for (Key y = y0; y <= y1; ++y) {
      for (Key x = x0; x <= x1; ++x) visit(x + size_x_ * (y + size_y_ * z));
    }
  }
}

std::span<const CVertexId> GridCellIndex::c_vertices(Key cell) const {
  const auto [from, to] = std::equal_range(keys_.begin(), keys_.end(), cell);
  return {items_.data() + (from - keys_.begin()), static_cast<std::size_t>(to - from)};
}

std::vector<GridCellIndex::Key> GridCellIndex::cells() const {
  std::vector<Key> out(keys_);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

Vec3 GridCellIndex::low(Key cell) const {
  return {static_cast<double>(cell % size_x_), static_cast<double>(cell / size_x_ % size_y_),
          static_cast<double>(cell / size_x_ / size_y_)};
}

std::vector<Farthest> prove_surface_near(const MeasuredSurface& surface,
                                         const GridCellIndex& grid_cell_index,
                                         const LevelMesh& mesh, std::span<const CellId> cell_of,
                                         std::span<const CellId> cells, double bound) {
  std::vector<Farthest> out(cells.size());
  for_each_chunk_reporting(cells.size(), kProvedCellsPerChunk, surface.control,
                           [&](std::size_t begin, std::size_t end) {
                             GridCellSearch search(surface, grid_cell_index, mesh, cell_of, bound);
                             for (std::size_t i = begin; i < end; ++i) {
                               surface.check_cancelled();
                               out[i] = search.search(cells[i]);
                             }
                           });
  return out;
}

}  // namespace isoatlas::detail
