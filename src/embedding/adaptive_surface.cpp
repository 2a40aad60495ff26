// SPDX-License-Identifier: Apache-2.0
#include "embedding/adaptive_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/append.h"
#include "core/cancel_poll.h"
#include "core/parallel.h"
#include "core/ranges.h"
#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "embedding/grid_cell.h"
#include "embedding/separate_pieces.h"

namespace isoatlas::detail {
namespace {

// Number of axes along which a point is on a layer of samples: 0 inside a grid cell, 1 on a wall, 2
// on an edge.
int integer_coordinates(Vec3 p) {
  return (p.x == std::floor(p.x)) + (p.y == std::floor(p.y)) + (p.z == std::floor(p.z));
}

constexpr std::size_t kPerChunk = 8192;  // c-vertices or faces, of a parallel loop

// The multi-sheet grid cells are separated for the points on walls that later subdivisions insert.
// These depend on nodes that parsing placed, so all positions are rounded first: the zero of the
// field on a wall can lie just inside the wall for one position and just outside for the other.
SurfaceComplex with_rounded_positions(SurfaceComplex complex) {
  for_each_index(complex.positions.size(), kPerChunk,
                 [&](std::size_t v) { complex.positions[v] = rounded(complex.positions[v]); });
  return complex;
}

// The grid cell of a face that lies in one.
GridCell grid_cell_of_face(const SurfaceComplex& complex, const Face& face) {
  Vec3 sum;
  for (int k = 0; k < face.size(); ++k) sum = sum + complex.positions[face.corner[k]];
  return grid_cell_of((1.0 / face.size()) * sum);
}

}  // namespace

AdaptiveSurface::AdaptiveSurface(SurfaceComplex complex, Components components, Nesting nesting,
                                 InterpolatedField field, const RunControl& control,
                                 std::optional<CapReference> caps, const SharedBox& shared)
    : complex_(with_rounded_positions(std::move(complex))),
      components_(std::move(components)),
      nesting_(std::move(nesting)),
      field_(std::move(field)),
      control_(without_stages(control)),
      caps_(std::move(caps)),
      shared_(shared),
      multi_sheet_cells_(complex_, field_, control_),
      parsed_count_(complex_.c_vertex_count()),
      depth_(parsed_count_, 0) {
  original_positions_ = complex_.positions;
  report_continuing(control_);
  multi_sheet_cells_.separate(complex_, control_);
  report_continuing(control_);
  update_checked_cells();
}

// C-vertices inside a grid cell are movable: the surface there is a cone about them, or the grid
// cell is checked. Nodes are movable on their edges, and points on their walls, once all faces
// around them are fans or pieces and the adjacent grid cells contain cones or are checked.
void AdaptiveSurface::update_checked_cells() {
  const std::uint32_t n = complex_.c_vertex_count();
  const std::vector<Fineness> current = fineness();
  std::vector<std::uint8_t> is_in_checked_cell(
      n, 0);  // inside a multi-sheet grid cell, which will be checked
  std::vector<std::uint8_t> in_two_curves(n, 0);
  fixed_.assign(n, 0);
  CancelPoll poll(control_);
  for_each_index(n, kPerChunk, &control_, [&](std::size_t i) {
    const auto v = static_cast<CVertexId>(i);
    const int whole = integer_coordinates(complex_.positions[v]);
    in_two_curves[v] = whole == 1 && has_two_curves(field_, complex_.positions[v]);
    const bool parsed_on_volume_boundary = v < parsed_count_ && whole == 1 && !in_two_curves[v];
    fixed_[v] = whole > 0 && current[v] == Fineness::faces && !parsed_on_volume_boundary;
    is_in_checked_cell[v] = whole == 0 && multi_sheet_cells_.contains(v);
  });
  control_.check_cancelled();
  std::vector<GridCell> grid_cells = grid_cells_with_small_pieces_;
  const auto add_inside =
      [&](const Face& face,
          std::vector<CVertexId>& found) {  // finds c-vertices inside such grid cells
        const int size = face.size();
        const auto end = face.corner.begin() + size;
        if (std::none_of(face.corner.begin(), end,
                         [&](CVertexId v) { return in_two_curves[v] || is_in_checked_cell[v]; }))
          return;
        for (int k = 0; k < size; ++k) {
          const CVertexId v = face.corner[k];
          if (integer_coordinates(complex_.positions[v]) > 0) continue;
          if (in_two_curves[face.corner[(k + 1) % size]] ||
              in_two_curves[face.corner[(k + 2) % size]] || is_in_checked_cell[v])
            found.push_back(v);
        }
      };
  std::vector<CVertexId> inside = collect_chunks<CVertexId>(
      complex_.face_count(), kPerChunk, [&](std::size_t begin, std::size_t end, auto& found) {
        control_.check_cancelled();
        for (std::size_t f = begin; f < end; ++f) add_inside(complex_.faces[f], found);
      });
  control_.check_cancelled();
  std::sort(inside.begin(), inside.end());
  inside.erase(std::unique(inside.begin(), inside.end()), inside.end());
  for (const CVertexId v : inside) grid_cells.push_back(grid_cell_of(complex_.positions[v]));
  // Only these grid cells contain c-vertices that a subdivision has added.
  if (!grid_cells_with_small_pieces_.empty()) {
    inside.clear();
    for (CVertexId v = 0; v < n; ++v) {
      if (integer_coordinates(complex_.positions[v]) == 0) inside.push_back(v);
    }
  }
  control_.check_cancelled();
  ranges::sort_unique(grid_cells);
  control_.check_cancelled();
  // Grid cells with faces that are not even fans cannot be checked.
  std::vector<GridCell> unsplit;
  for (const CVertexId v : inside) {
    poll.step();
    if (current[v] != Fineness::faces) continue;
    const GridCell grid_cell = grid_cell_of(complex_.positions[v]);
    if (std::binary_search(grid_cells.begin(), grid_cells.end(), grid_cell))
      unsplit.push_back(grid_cell);
  }
  ranges::sort_unique(unsplit);
  is_in_unsplit_grid_cell_.assign(n, 0);
  for_each_index(inside.size(), kPerChunk, &control_, [&](std::size_t i) {
    is_in_unsplit_grid_cell_[inside[i]] = std::binary_search(
        unsplit.begin(), unsplit.end(), grid_cell_of(complex_.positions[inside[i]]));
  });
  for (const Face& face : complex_.faces) {
    if (std::none_of(face.corner.begin(), face.corner.begin() + face.size(),
                     [&](CVertexId v) { return is_in_unsplit_grid_cell_[v]; }))
      continue;
    for (int k = 0; k < face.size(); ++k)
      fixed_[face.corner[k]] |= integer_coordinates(complex_.positions[face.corner[k]]) > 0;
  }
  report_continuing(control_);
  std::vector<GridCell> checkable;
  std::set_difference(grid_cells.begin(), grid_cells.end(), unsplit.begin(), unsplit.end(),
                      std::back_inserter(checkable));
  checked_cells_ = CheckedCells(complex_, checkable, control_);
}

std::vector<CVertexId> AdaptiveSurface::find_conflicting_moves(
    std::span<const CVertexId> moved, std::span<const Vec3> before, std::span<Vec3> positions,
    std::span<const CVertexId> check) const {
  struct Mover {
    CVertexId v;
    std::uint32_t number;  // index in `moved`
    bool is_reverted = false;
  };
  std::vector<Mover> movers;
  movers.reserve(moved.size());
  for (std::uint32_t i = 0; i < moved.size(); ++i) movers.push_back({moved[i], i});
  ranges::sort(movers, {}, &Mover::v);
  std::vector<std::pair<CVertexId, Vec3>> changed;  // positions to restore at the end
  std::vector<CVertexId> out, next(check.begin(), check.end());
  while (!next.empty()) {
    std::vector<CVertexId> reverted = checked_cells_.intersecting(next, positions, control_);
    for (const CVertexId v : multi_sheet_cells_.intersecting(next, positions, control_)) {
      if (is_in_unsplit_grid_cell_[v]) reverted.push_back(v);
    }
    next.clear();
    for (const CVertexId v : reverted) {
      const auto mover = ranges::lower_bound(movers, v, {}, &Mover::v);
      if (mover == movers.end() || mover->v != v || std::exchange(mover->is_reverted, true))
        continue;
      changed.emplace_back(v, std::exchange(positions[v], before[mover->number]));
      next.push_back(v);
    }
    out.insert(out.end(), next.begin(), next.end());
  }
  for (const auto& [v, position] : changed) positions[v] = position;
  return out;
}

// Multi-sheet grid cells are subdivided as a whole or not at all, so that they can be checked. This
// includes those that a face to be subdivided reaches into.
std::vector<CVertexId> AdaptiveSurface::with_multi_sheet_grid_cells(
    std::span<const CVertexId> wanted) const {
  std::vector<std::uint8_t> is_wanted(complex_.c_vertex_count(), 0);
  for (const CVertexId v : wanted) is_wanted[v] = 1;
  std::vector<CVertexId> out(wanted.begin(), wanted.end());
  const auto add_cell_of = [&](CVertexId v) {
    for (const CVertexId w : multi_sheet_cells_.c_vertices_in_grid_cell_of(v)) {
      if (std::exchange(is_wanted[w], std::uint8_t{1}) == 0) out.push_back(w);
    }
  };
  for (const CVertexId v : wanted) {
    if (multi_sheet_cells_.contains(v)) add_cell_of(v);
  }
  for (std::size_t before = 0; before != out.size();) {
    before = out.size();
    control_.check_cancelled();
    for (const Face& face : complex_.faces) {
      if (face.is_triangle()) continue;
      const auto end = face.corner.begin() + face.size();
      if (std::none_of(face.corner.begin(), end, [&](CVertexId v) { return is_wanted[v]; }))
        continue;
      for (auto v = face.corner.begin(); v != end; ++v) {
        if (multi_sheet_cells_.contains(*v)) add_cell_of(*v);
      }
    }
  }
  return out;
}

// Only c-vertices that are alone in a grid cell, where they may be anywhere as long as nothing
// around them is subdivided.
void AdaptiveSurface::move_off_walls(std::span<const CVertexId> wanted,
                                     std::span<const CVertexId> fixed) {
  std::vector<std::uint8_t> is_fixed(complex_.c_vertex_count(), 0);
  for (const CVertexId v : fixed) is_fixed[v] = 1;
  for (const Face& face : complex_.faces) {
    if (!face.is_triangle()) continue;
    for (int k = 0; k < 3; ++k) is_fixed[face.corner[k]] = 1;
  }
  for (const CVertexId v : wanted) {
    Vec3& p = complex_.positions[v];
    if (is_fixed[v] || multi_sheet_cells_.contains(v) || integer_coordinates(p) > 0) continue;
    const auto inside = [](double x) {
      return std::clamp(x, std::floor(x) + kWallMargin, std::floor(x) + 1 - kWallMargin);
    };
    const Vec3 kept = rounded({inside(p.x), inside(p.y), inside(p.z)});
    if (kept == p) continue;
    p = kept;
    touched_.push_back(v);
  }
}

// Subdivides the faces around each c-vertex to the next fineness. Where pieces become smaller,
// everything else in their grid cells has to consist of pieces first, so that they can be compared.
void AdaptiveSurface::subdivide(std::span<const CVertexId> wanted,
                                std::span<const CVertexId> fixed) {
  const std::vector<Fineness> old_fineness = fineness();
  const CVertexId count_before = complex_.c_vertex_count();
  touched_.clear();
  move_off_walls(wanted, fixed);
  std::vector<std::uint8_t> is_wanted(complex_.c_vertex_count(), 0);
  for (const CVertexId v : wanted) is_wanted[v] = old_fineness[v] == Fineness::pieces;
  std::vector<GridCell> grid_cells;
  for (const Face& face : complex_.faces) {
    const auto end = face.corner.begin() + face.size();
    if (std::any_of(face.corner.begin(), end, [&](CVertexId v) { return is_wanted[v]; }))
      grid_cells.push_back(grid_cell_of_face(complex_, face));
  }
  control_.check_cancelled();
  ranges::sort_unique(grid_cells);
  std::vector<Fineness> current = old_fineness;
  for (;; current = fineness()) {
    std::vector<CVertexId> not_in_pieces;
    for (CVertexId v = 0; v < complex_.c_vertex_count() && !grid_cells.empty(); ++v) {
      const Vec3 p = complex_.positions[v];
      if (current[v] == Fineness::pieces || integer_coordinates(p) > 0) continue;
      if (std::binary_search(grid_cells.begin(), grid_cells.end(), grid_cell_of(p)))
        not_in_pieces.push_back(v);
    }
    control_.check_cancelled();
    if (not_in_pieces.empty()) break;
    report_continuing(control_);
    subdivide_once(with_multi_sheet_grid_cells(not_in_pieces), current);
  }
  std::vector<CVertexId> left;
  std::copy_if(wanted.begin(), wanted.end(), std::back_inserter(left),
               [&](CVertexId v) { return current[v] == old_fineness[v]; });
  subdivide_once(with_multi_sheet_grid_cells(left), current);
  // Later steps also replace faces of c-vertices that earlier ones added.
  std::erase_if(touched_, [&](CVertexId v) { return v >= count_before; });
  report_continuing(control_);
  update_checked_cells();
}

void AdaptiveSurface::subdivide_once(std::span<const CVertexId> wanted,
                                     const std::vector<Fineness>& old_fineness) {
  const CVertexId before = complex_.c_vertex_count();
  int new_depth = 0;
  for (const CVertexId v : wanted) new_depth = std::max(new_depth, depth_[v] + 1);
  const Subdivision subdivision = subdivide_in_place(
      complex_, wanted, old_fineness, {field_, multi_sheet_cells_.flags(), &control_});
  report_continuing(control_);
  touched_.insert(touched_.end(), subdivision.touched.begin(), subdivision.touched.end());
  std::vector<ComponentId> component;
  std::vector<std::uint8_t> depth;
  for (const CVertexId from : subdivision.origin) {
    component.push_back(components_.of_c_vertex[from]);
    depth.push_back(static_cast<std::uint8_t>(std::min(new_depth, depth_[from] + 1)));
  }
  append(components_.of_c_vertex, component.begin(), component.end());
  append(depth_, depth.begin(), depth.end());
  append(original_positions_, complex_.positions.begin() + before, complex_.positions.end());
  subdivision_count_ += wanted.size();
  added_count_ += subdivision.origin.size();
  if (!subdivision.origin.empty()) max_depth_ = std::max(max_depth_, new_depth);
  if (std::any_of(wanted.begin(), wanted.end(),
                  [&](CVertexId v) { return old_fineness[v] == Fineness::pieces; }))
    flatten_intersecting_pieces(subdivision, before);
}

// Moves new points in grid cells with intersecting pieces towards the midpoints of their sides. At
// these midpoints pieces are parts of the flat triangles that were subdivided, and intersect only
// where these triangles do.
void AdaptiveSurface::flatten_intersecting_pieces(const Subdivision& subdivision,
                                                  CVertexId first_new) {
  std::vector<FreePoint> free;
  for (CVertexId v = first_new; v < complex_.c_vertex_count(); ++v) {
    const auto [a, b] = subdivision.between[v - first_new];
    if (a != kNone) free.push_back({v, 0.5 * (complex_.positions[a] + complex_.positions[b])});
  }
  const auto is_free = [&](CVertexId v) {
    return v >= first_new && subdivision.between[v - first_new][0] != kNone;
  };
  CancelPoll poll(control_);
  std::vector<GridCell> grid_cells;
  for (const Face& face : complex_.faces) {
    poll.step();
    if (!face.is_triangle() || !std::any_of(face.corner.begin(), face.corner.begin() + 3, is_free))
      continue;
    grid_cells.push_back(grid_cell_of_face(complex_, face));
  }
  ranges::sort_unique(grid_cells);
  grid_cells_with_small_pieces_.insert(grid_cells_with_small_pieces_.end(), grid_cells.begin(),
                                       grid_cells.end());
  ranges::sort_unique(grid_cells_with_small_pieces_);
  std::vector<Piece> pieces;
  for (const Face& face : complex_.faces) {
    poll.step();
    if (!face.is_triangle()) continue;
    const GridCell grid_cell = grid_cell_of_face(complex_, face);
    if (!std::binary_search(grid_cells.begin(), grid_cells.end(), grid_cell)) continue;
    pieces.push_back({grid_cell, {face.corner[0], face.corner[1], face.corner[2]}});
  }
  control_.check_cancelled();
  separate_pieces(free, std::move(pieces), complex_.positions, control_);
}

}  // namespace isoatlas::detail
